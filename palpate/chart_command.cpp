#include "palpate/chart_command.h"

#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "modules/core/error.h"

namespace palpate::launcher {

std::vector<std::string> chart_names() { return {"accuracy", "paper", "neighbours"}; }

std::string chart_program(std::vector<std::string>& words) {
  const auto names = chart_names();
  std::string what = names.front();
  if (!words.empty() && words[0].rfind('-', 0) != 0) {
    what = words[0];
    words.erase(words.begin());
  }
  if (std::find(names.begin(), names.end(), what) == names.end()) {
    throw InputError(fmt::format("chart '{}': must be one of {}", what, fmt::join(names, ", ")));
  }
  return fmt::format("palpate-bench-{}", what);
}

void become(const std::filesystem::path& program, const std::vector<std::string>& words) {
  const std::string name = program.string();
  if (!std::filesystem::exists(program)) {
    throw InputError(fmt::format("{} is missing; build it", name));
  }
  std::vector<char*> arguments{const_cast<char*>(name.c_str())};
  for (const auto& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  execv(name.c_str(), arguments.data());
  throw std::runtime_error(fmt::format("cannot start {}: {}", name, std::strerror(errno)));
}

}  // namespace palpate::launcher
