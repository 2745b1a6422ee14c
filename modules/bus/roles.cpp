#include "modules/bus/roles.h"

#include <algorithm>

#include "modules/bus/topics.h"

namespace palpate::bus {
namespace {

using Names = std::vector<std::string_view>;

Names everything() {
  Names names;
  for (const TopicInfo& topic : all_topics()) names.push_back(topic.name);
  return names;
}

/// A process of the session: it says how it is, and hears what all hear.
Role process(std::string_view name, Names writes, Names reads) {
  writes.push_back(kModuleStatus.name);
  reads.insert(reads.end(), {kScene.name, kSessionControl.name});
  return {name, std::move(writes), std::move(reads)};
}

Role driver(std::string_view name) {
  return {name,
          {kProbeInput.name},
          {kHapticForce.name, kProbeState.name, kScene.name, kSessionControl.name}};
}

/// Over hosts everybody asks the others' clocks, and answers.
std::vector<Role> with_clocks(std::vector<Role> roles) {
  for (Role& role : roles) {
    role.writes.push_back(kClock.name);
    if (std::ranges::find(role.reads, kClock.name) == role.reads.end())
      role.reads.push_back(kClock.name);
  }
  return roles;
}

}  // namespace

std::span<const Role> roles() {
  static const std::vector<Role> all = with_clocks(
      {{"palpate", {kScene.name, kSessionControl.name}, everything()},
       process("deformation", {kSurface.name, kNodePositions.name, kContactModel.name},
               {kProbeState.name, kContacts.name}),
       process("collision", {kContacts.name},
               {kSurface.name, kNodePositions.name, kProbeState.name}),
       process("haptics", {kProbeState.name, kHapticForce.name},
               {kProbeInput.name, kContactModel.name}),
       {"visualizer", {kProbeInput.name, kSessionControl.name, kModuleStatus.name}, everything()},
       {"recorder", {kModuleStatus.name}, everything()},
       driver("driver"),
       driver("emulated_device"),
       {"viewer", {}, everything()}});
  return all;
}

const Role* find_role(std::string_view name) {
  const auto role = std::ranges::find(roles(), name, &Role::name);
  if (role != roles().end()) return &*role;
  const auto sign = name.rfind('_');
  const bool numbered = sign != std::string_view::npos && sign + 1 < name.size() &&
                        name.find_first_not_of("0123456789", sign + 1) == std::string_view::npos;
  return numbered ? find_role(name.substr(0, sign)) : nullptr;
}

}  // namespace palpate::bus
