// Who may say and hear what in a session with keys.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace palpate::bus {

/// A role is named as the participants that play it (BusOptions::participant_name).
struct Role {
  std::string_view name;
  std::vector<std::string_view> writes, reads;  ///< topics
};

/// Each process of a session, "palpate" (the launcher, and programs that name no other), "driver"
/// (of a device), and "viewer" (hears all, says nothing).
std::span<const Role> roles();
/// "deformation_2", one of several processes of a job, plays that job's. nullptr if there is none.
const Role* find_role(std::string_view name);

}  // namespace palpate::bus
