// Which network interfaces the topics use.
#pragma once

#include <string>
#include <vector>

namespace palpate::bus {

/// IPv4 addresses of this host's interfaces in a comma-separated list; loopback if it is null or
/// empty. Environment variable PALPATE_INTERFACES of each process.
/// @throws InputError for an address that this host does not have
std::vector<std::string> interfaces_from(const char* comma_separated);

}  // namespace palpate::bus
