// Which host of a session runs what: the file that `palpate run --hosts` reads, the same on all of
// them.
//
//   palpate_hosts: 1
//   hosts:
//     - {name: bench, address: 10.0.0.5, modules: [haptics, collision]}   # the first one conducts
//     - {name: rack, address: 10.0.0.6, modules: [deformation]}
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace palpate::launcher {

struct HostEntry {
  std::string name;
  std::string address;               ///< IPv4, by which the others reach it
  std::vector<std::string> modules;  ///< at least one
};

struct HostsFile {
  std::vector<HostEntry> hosts;  ///< at least one; the first conducts the session

  /// @throws InputError naming --host if there is none of that name
  const HostEntry& host(const std::string& name) const;
  bool conducts(const std::string& name) const { return hosts.front().name == name; }
  std::vector<std::string> all_modules() const;
  /// Addresses of the others, separated by commas: what PALPATE_PEERS is to be.
  std::string peers_of(const std::string& name) const;
};

/// @throws InputError with file and line for a file that is not one: a key unknown or missing, an
/// address that is none, a module that does not exist or is on two hosts, names or addresses twice
HostsFile load_hosts(const std::filesystem::path& file);

}  // namespace palpate::launcher
