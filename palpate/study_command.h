// Measurements are programs of their own: `palpate WORD …` becomes palpate-WORD.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace palpate::launcher {

struct Study {
  const char* word;     ///< the program is palpate-WORD, beside `palpate`
  const char* meaning;  ///< one line of --help
};

/// In the order of --help.
const std::vector<Study>& studies();

/// Becomes the program: its output, its exit code, its Ctrl-C.
/// @throws InputError naming a program that is missing; std::runtime_error if it cannot be started
[[noreturn]] void become(const std::filesystem::path& program,
                         const std::vector<std::string>& words);

}  // namespace palpate::launcher
