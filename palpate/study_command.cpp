#include "palpate/study_command.h"

#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "modules/core/error.h"

namespace palpate::launcher {

const std::vector<Study>& studies() {
  static const std::vector<Study> kStudies{
      {"certify", "Hold hand, device, haptics and organ to their limits, line by line"},
      {"chart", "Measure and draw speed against accuracy of all models"},
      {"plan", "Find the cheapest model, mesh and step that meet a scene's needs"},
      {"stability", "Map where each method fails, measured and predicted"},
      {"fuzz", "Run random scenes, looking for one that fails without a guard noticing"},
      {"contact-loop", "Move balls in and out of organs, looking for a contact that is lost"},
      {"volume-methods", "Compare ways to keep a volume"},
      {"paper", "Make the figures and numbers of the paper anew"},
      {"calibrate", "Fit springs to squeezed balls of finite elements"},
      {"elements", "Compare finite elements with reference solutions"}};
  return kStudies;
}

void become(const std::filesystem::path& program, const std::vector<std::string>& words) {
  const std::string name = program.string();
  if (!std::filesystem::exists(program)) {
    const std::string word = program.filename().string();
    throw InputError(fmt::format(
        "{} is missing; build it: cmake --build --preset release --target {}", name, word));
  }
  std::vector<char*> arguments{const_cast<char*>(name.c_str())};
  for (const auto& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  execv(name.c_str(), arguments.data());
  throw std::runtime_error(fmt::format("cannot start {}: {}", name, std::strerror(errno)));
}

}  // namespace palpate::launcher
