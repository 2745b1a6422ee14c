// Words that a shell may offer behind `palpate COMMAND …`, as the command's own --help has them.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace palpate::launcher {

/// What may stand behind a command.
struct CommandWords {
  struct Value {
    bool several = false;                   ///< up to the next option
    std::vector<std::string> allowed = {};  ///< as far as they are told
  };
  std::vector<std::string> options;     ///< "--json", in their order
  std::map<std::string, Value> values;  ///< of options that take one
  std::map<std::string, Value> places;  ///< of what stands without an option: "SCENE"
};

/// @param help  lines of --help, as the parser of all programs lays them out
CommandWords words_in(const std::vector<std::string>& help);

/// What may stand in the place of the last of `typed`; nothing where that is a file or a number.
/// @param typed   behind the command, the last one perhaps begun
/// @param scenes  names of shipped scenes
std::vector<std::string> completions(const CommandWords& words,
                                     const std::vector<std::string>& typed,
                                     const std::vector<std::string>& scenes);

/// The lines of `palpate COMMAND --help`, which a program of its own may say.
std::vector<std::string> help_of(const std::string& command);

}  // namespace palpate::launcher
