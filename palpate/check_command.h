// `palpate check`: what a scene holds and what it costs on this machine.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

namespace palpate::launcher {

struct CheckOptions {
  std::filesystem::path scene;
  std::vector<std::string> settings = {};  ///< as of RunOptions
  double measure_for = 1;                  ///< about how long a step's cost is measured [s]
  bool resolved = false;                   ///< the scene with every default, and nothing else
  bool json = false;
};

/// Prints the verdict first: can it run, does it keep up here, and what is doubtful.
/// @param log  gets the progress of reading a long recording
/// @return an exit code of core/error.h
/// @throws InputError for a scene, mesh or recording that cannot be used
int check_command(const CheckOptions& options, std::ostream& out, std::ostream& log);

}  // namespace palpate::launcher
