// Whether a folder of keys lets a role take part, found out before DDS is asked.
#pragma once

#include <filesystem>
#include <string_view>

namespace palpate::bus {

/// Those of one role in a folder of keys; authority and governance are all roles'.
struct KeyFiles {
  std::filesystem::path authority, governance, certificate, key, permissions;
};
KeyFiles key_files(const std::filesystem::path& folder, std::string_view role);

/// All files of the role are there, its key is its owner's alone, nobody else may write to the
/// folder or what is in it, they belong together, are signed by the folder's authority, name the
/// role and hold now.
/// @throws InputError which file, what is wrong with it and what to do
void check_keys(const std::filesystem::path& folder, std::string_view role);

}  // namespace palpate::bus
