#include "modules/launcher/chart_command.h"

#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "modules/core/error.h"

namespace palpate::launcher {

std::vector<std::string> chart_names() { return {"paper", "neighbours"}; }

std::filesystem::path chart_program(const std::string& what,
                                    const std::filesystem::path& program_folder) {
  const auto names = chart_names();
  if (std::find(names.begin(), names.end(), what) == names.end()) {
    throw InputError(fmt::format("chart '{}': must be one of {}", what, fmt::join(names, ", ")));
  }
  auto program = program_folder / fmt::format("palpate-bench-{}", what);
  if (!std::filesystem::exists(program)) {
    throw InputError(fmt::format("chart {}: {} is missing; build it", what, program.string()));
  }
  return program;
}

void chart_command(const std::vector<std::string>& words,
                   const std::filesystem::path& program_folder) {
  const std::string program =
      chart_program(words.empty() ? std::string() : words[0], program_folder).string();
  std::vector<char*> arguments{const_cast<char*>(program.c_str())};
  for (std::size_t i = 1; i < words.size(); ++i) {
    arguments.push_back(const_cast<char*>(words[i].c_str()));
  }
  arguments.push_back(nullptr);
  execv(program.c_str(), arguments.data());
  throw std::runtime_error(fmt::format("cannot start {}: {}", program, std::strerror(errno)));
}

}  // namespace palpate::launcher
