// `palpate volume-methods`: the methods of the paper's related work side by side.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

namespace palpate::volume_methods {

struct VolumeMethodsOptions {
  std::filesystem::path out;      ///< folder for volume_methods.csv; empty: no file
  std::vector<std::string> only;  ///< names of compared_methods(); empty: all
  bool quick = false;             ///< ball of 162 nodes, organ cut short
  std::filesystem::path scene;    ///< whose first organ is pressed
};

/// Measures and prints one row per method. Nothing but the costs depends on the machine.
/// @return an exit code of core/error.h, or 130 (as shells count Ctrl-C) if it was stopped
/// @throws InputError for a scene or folder that cannot be used
int run_volume_methods(const VolumeMethodsOptions& options, std::ostream& out, std::ostream& log);

}  // namespace palpate::volume_methods
