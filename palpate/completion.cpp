#include "palpate/completion.h"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <sstream>
#include <thread>
#include <utility>

#include "modules/core/data_folder.h"
#include "palpate/child_process.h"

namespace palpate::launcher {
namespace {

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> parts;
  std::string part;
  for (const char c : text + ",") {
    if (c == ' ') continue;
    if (c != ',') part += c;
    if (c == ',' && !part.empty()) parts.push_back(std::exchange(part, {}));
  }
  return parts;
}

/// "TEXT:{hollow,solid} …", or "TEXT ...  Only these cases: ball, block"; nothing of a flag.
std::optional<CommandWords::Value> value_of(const std::string& rest) {
  std::istringstream words(rest);
  std::string type, behind;
  words >> type >> behind;
  const auto is_type = [&](const char* name) { return type.starts_with(name); };
  if (!is_type("TEXT") && !is_type("INT") && !is_type("UINT") && !is_type("FLOAT")) return {};
  CommandWords::Value value{.several = behind == "..."};
  const auto open = type.find(":{"), close = type.find('}');
  if (open != std::string::npos && close != std::string::npos) {
    value.allowed = split(type.substr(open + 2, close - open - 2));
  }
  const auto these = rest.find("Only these ");
  const auto colon = rest.find(": ", these == std::string::npos ? rest.size() : these);
  if (colon != std::string::npos) value.allowed = split(rest.substr(colon + 1));
  return value;
}

void add_line(const std::string& line, CommandWords& words) {
  const auto end = std::min(line.find(' ', 2), line.size());
  const std::string names = line.substr(2, end - 2), rest = line.substr(end);
  const auto value = value_of(rest);
  if (names[0] != '-') {
    words.places[names] = value.value_or(CommandWords::Value{});
    return;
  }
  for (const std::string& name : split(names)) {
    if (name.starts_with("--")) words.options.push_back(name);
    if (value) words.values[name] = *value;
  }
}

/// Of the option that the last word belongs to; none if it stands for itself.
const CommandWords::Value* open_value(const CommandWords& words,
                                      const std::vector<std::string>& typed) {
  for (std::size_t i = typed.size() - 1; i-- > 0;) {
    if (!typed[i].starts_with('-')) continue;
    const auto found = words.values.find(typed[i]);
    if (found == words.values.end()) return nullptr;
    const bool next = i + 2 == typed.size();
    return next || found->second.several ? &found->second : nullptr;
  }
  return nullptr;
}

}  // namespace

CommandWords words_in(const std::vector<std::string>& help) {
  CommandWords words;
  for (const std::string& line : help) {
    const bool is_named = line.size() > 2 && line.starts_with("  ") && line[2] != ' ';
    if (is_named) add_line(line, words);
  }
  return words;
}

std::vector<std::string> completions(const CommandWords& words,
                                     const std::vector<std::string>& typed,
                                     const std::vector<std::string>& scenes) {
  const bool begins_option = !typed.empty() && typed.back().starts_with('-');
  if (!typed.empty() && !begins_option) {
    if (const auto* value = open_value(words, typed)) return value->allowed;
  }
  std::vector<std::string> offered;
  for (const auto& [name, value] : words.places) {
    if (begins_option) break;
    std::ranges::copy(name == "SCENE" ? scenes : value.allowed, std::back_inserter(offered));
  }
  std::ranges::copy(words.options, std::back_inserter(offered));
  return offered;
}

std::vector<std::string> help_of(const std::string& command) {
  constexpr std::chrono::milliseconds kPause{2};
  ChildProcess program(program_folder() / "palpate", {command, "--help"});
  while (!program.ended()) std::this_thread::sleep_for(kPause);
  return program.take_lines();
}

}  // namespace palpate::launcher
