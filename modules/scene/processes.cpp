#include "modules/scene/processes.h"

#include <algorithm>

#include "modules/core/organ_limits.h"

namespace palpate::scene {
namespace {

std::string key_of(std::size_t organ) { return "organs[" + std::to_string(organ) + "].process"; }

}  // namespace

std::size_t process_count(const Scene& scene) {
  std::size_t count = 1;
  for (const Organ& organ : scene.organs) count = std::max(count, organ.process);
  return count;
}

std::vector<std::size_t> organs_of(const Scene& scene, std::size_t process) {
  std::vector<std::size_t> organs;
  for (std::size_t i = 0; i < scene.organs.size(); ++i) {
    if (scene.organs[i].process == process) organs.push_back(i);
  }
  return organs;
}

Scene part_of(const Scene& scene, std::size_t process) {
  Scene part = scene;
  std::erase_if(part.organs, [&](const Organ& organ) { return organ.process != process; });
  return part;
}

Scene in_one_process(Scene scene) {
  for (Organ& organ : scene.organs) organ.process = 1;
  return scene;
}

Misfit misfit_of_processes(const Scene& scene) {
  const std::size_t laws = process_count(scene) * scene.probes.size();
  for (std::size_t i = 0; i < scene.organs.size(); ++i) {
    const std::size_t process = scene.organs[i].process;
    if (process == 1) continue;  // there may be no key to point at
    if (organs_of(scene, process - 1).empty()) {
      return {key_of(i), "is " + std::to_string(process) + ", but no organ has process " +
                             std::to_string(process - 1) + "; they count up from 1 without a gap"};
    }
    if (laws > kMaxKeys) {
      return {key_of(i), "makes " + std::to_string(laws) + " contact models, one for each of " +
                             std::to_string(scene.probes.size()) +
                             " probes from each process; there may be at most " +
                             std::to_string(kMaxKeys)};
    }
    const auto other = std::ranges::find_if(
        scene.organs, [&](const Organ& organ) { return organ.process != process; });
    if (scene.contacts.organs && other != scene.organs.end()) {
      return {key_of(i), "must be that of organ '" + other->name + "', " +
                             std::to_string(other->process) +
                             ": organs that may touch (contacts.organs) share a process"};
    }
  }
  return {};
}

}  // namespace palpate::scene
