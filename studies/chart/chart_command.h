// `palpate chart`: what each model costs and how wrong it is, on the same cases.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "studies/chart/reference_solutions.h"
#include "studies/chart/sweep.h"

namespace palpate::chart {

struct ChartOptions {
  std::filesystem::path out = "out/accuracy";
  std::vector<std::string> only_cases;  ///< empty: all
  std::vector<std::string> only_models;
  Extent extent = Extent::kUsual;
  std::filesystem::path bullet_program;  ///< palpate-bench-bullet, if it was built
  bool peers = true;
  int places = kPlaces;                     ///< of organs, the first so many
  bool again = false;                       ///< measures anew what has been measured
  std::optional<report::Shard> shard = {};  ///< measures what no other does, writes no tables
};

/// What only_cases may hold.
std::vector<std::string> case_names();

/// The whole command. @return an exit code @throws InputError
int run_chart(const ChartOptions& options, std::ostream& out, std::ostream& log);

}  // namespace palpate::chart
