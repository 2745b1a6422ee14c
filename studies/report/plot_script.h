// Draws the figures: runs a script of scripts/plots.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace palpate::report {

/// Exit code of a program that speaks for itself; -1 if it could not be started or was killed.
int run_program(const std::vector<std::string>& words);

/// Runs `python3 script folder words…`, with the system's python3 where the one in PATH has no
/// matplotlib.
/// @throws std::runtime_error saying what is missing, or that the script failed
void draw_figures(const std::filesystem::path& script, const std::filesystem::path& folder,
                  const std::vector<std::string>& words = {});

}  // namespace palpate::report
