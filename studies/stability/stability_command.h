// `palpate stability`: the atlas. Where each method fails, measured and predicted.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "studies/report/claims.h"

namespace palpate::stability {

struct StabilityOptions {
  std::filesystem::path out = "out/stability";
  std::vector<std::string> only_maps;    ///< empty: all of map_names()
  std::vector<std::string> only_series;  ///< models or loops; empty: all of each map
  bool quick = false;
  bool again = false;                       ///< measures anew what has been measured
  std::optional<report::Shard> shard = {};  ///< measures what no other does, writes no tables
};

/// Of maps.h, and "locking".
std::vector<std::string> map_names();

/// The whole command: atlas.csv (every try), frontiers.csv, locking.csv, heat maps, and a summary
/// of predicted against measured frontiers. The same numbers on every machine.
/// @return an exit code of core/error.h, or 130 (as shells count Ctrl-C) if it was stopped
/// @throws InputError for maps or series that are not there
int run_stability(const StabilityOptions& options, std::ostream& out, std::ostream& log);

}  // namespace palpate::stability
