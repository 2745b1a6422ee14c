// `palpate chart`: the measurements that draw, each a program of its own.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace palpate::launcher {

/// WHAT of `palpate chart WHAT`; the program is palpate-bench-WHAT.
std::vector<std::string> chart_names();

/// The program of `what`. @throws InputError listing what there is, or naming the missing program
std::filesystem::path chart_program(const std::string& what,
                                    const std::filesystem::path& program_folder);

/// Becomes the program: its output, its exit code, its Ctrl-C.
/// @param words  WHAT and its own options
/// @throws InputError as chart_program(); std::runtime_error if it cannot be started
[[noreturn]] void chart_command(const std::vector<std::string>& words,
                                const std::filesystem::path& program_folder);

}  // namespace palpate::launcher
