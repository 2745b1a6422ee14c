// Commands that are programs of their own: the measurements, and what is built on them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace palpate::launcher {

/// WHAT of `palpate chart [WHAT]`; the program is palpate-bench-WHAT. The first one is meant where
/// none is named.
std::vector<std::string> chart_names();

/// The program of `palpate chart`, taking WHAT out of its words.
/// @param words  WHAT, if it is named, and the program's options
/// @throws InputError listing what there is
std::string chart_program(std::vector<std::string>& words);

/// Becomes the program: its output, its exit code, its Ctrl-C.
/// @throws InputError naming a program that is missing; std::runtime_error if it cannot be started
[[noreturn]] void become(const std::filesystem::path& program,
                         const std::vector<std::string>& words);

}  // namespace palpate::launcher
