// Where programs find what is installed beside them: scenes, reference tables, plot scripts.
#pragma once

#include <filesystem>

namespace palpate {

/// Folder of the running program, links followed.
std::filesystem::path program_folder();

/// PALPATE_SHARE of the environment; else ../share/palpate of the program's folder, in the build
/// tree as where it is installed.
std::filesystem::path data_folder();

/// @param name  below data_folder(), such as "scenes/ball_squeeze.yaml"
/// @throws InputError naming the missing file and PALPATE_SHARE
std::filesystem::path data_file(const std::filesystem::path& name);

}  // namespace palpate
