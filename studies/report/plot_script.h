// Draws the figures: runs a script of scripts/plots.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "studies/report/progress.h"

namespace palpate::report {

/// Exit code of a program that speaks for itself; -1 if it could not be started, was killed, or
/// nobody knows (where SIGCHLD is ignored).
/// @param keep_going  asked meanwhile, several times a second; what it throws ends the program
int run_program(const std::vector<std::string>& words, const KeepGoing& keep_going = {});

/// Runs `python3 script folder words…`, with the system's python3 where the one in PATH has no
/// matplotlib.
/// @throws std::runtime_error saying what is missing, or that the script failed; what
///         keep_going throws
void draw_figures(const std::filesystem::path& script, const std::filesystem::path& folder,
                  const std::vector<std::string>& words = {}, const KeepGoing& keep_going = {});

}  // namespace palpate::report
