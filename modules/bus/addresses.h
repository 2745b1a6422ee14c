// Where a process listens, and where it looks for others.
#pragma once

#include <string>
#include <vector>

namespace palpate::bus {

/// IPv4 addresses in dotted form.
struct Addresses {
  std::vector<std::string> own;    ///< of this host's interfaces, at least one
  std::vector<std::string> peers;  ///< of other hosts

  /// Whether another host can be heard at all: not if all are loopback.
  bool over_hosts() const;
};

/// IPv4, loopback among them.
std::vector<std::string> addresses_of_this_host();

/// Whether the interface that has an address runs (is up, with a link). A process that is started
/// while it does not hears nobody there, nor itself, as long as it lives: Fast DDS passes over it.
bool has_link(const std::string& address);

/// From the environment of a process: PALPATE_INTERFACES, loopback if null or empty, and
/// PALPATE_PEERS. Each is a comma-separated list.
/// @throws InputError for an address of PALPATE_INTERFACES that this host does not have, and one of
/// PALPATE_PEERS that is none
Addresses addresses_from(const char* interfaces, const char* peers);

}  // namespace palpate::bus
