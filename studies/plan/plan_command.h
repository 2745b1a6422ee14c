#pragma once

#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "studies/report/claims.h"

namespace palpate::plan {

struct PlanOptions {
  std::filesystem::path scene;
  std::filesystem::path out;  ///< scene file to write; empty: NAME.planned.yaml beside the scene,
                              ///< of a shipped one in the current folder
  double seconds = 6;         ///< of the scene, from its start
  std::vector<std::string> settings = {};  ///< "key=value" each, instead of what the scene says
  bool json = false;                       ///< the verdicts as JSON
  std::size_t touches = 6;                 ///< instants at which the truth is computed
  bool verify = false;                     ///< judges the choice by a finer truth at other instants
  std::filesystem::path points = {};       ///< folder of verdicts that shards left; empty: none
  std::optional<report::Shard> shard = {};  ///< judges candidates that no other run does
};

/// The whole command: measures, prints choice and runners-up with what they lost by, writes the
/// scene. @return an exit code: 1 if nothing meets the needs @throws InputError
int run_plan(const PlanOptions& options, std::ostream& out, std::ostream& log);

}  // namespace palpate::plan
