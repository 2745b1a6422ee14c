#include "modules/bus/addresses.h"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>

#include <algorithm>
#include <sstream>

#include "modules/core/error.h"

namespace palpate::bus {
namespace {

struct InterfaceAddress {
  std::string address;
  bool runs = false;
};

std::vector<InterfaceAddress> interface_addresses() {
  std::vector<InterfaceAddress> addresses;
  ifaddrs* interfaces = nullptr;
  if (getifaddrs(&interfaces) != 0) return addresses;
  for (const ifaddrs* i = interfaces; i != nullptr; i = i->ifa_next) {
    if (i->ifa_addr == nullptr || i->ifa_addr->sa_family != AF_INET) continue;
    char text[INET_ADDRSTRLEN] = "";
    // By void*: the general address is known to be an IPv4 one here.
    const void* const ipv4 = i->ifa_addr;
    inet_ntop(AF_INET, &static_cast<const sockaddr_in*>(ipv4)->sin_addr, text, sizeof text);
    addresses.push_back({text, (i->ifa_flags & IFF_RUNNING) != 0});
  }
  freeifaddrs(interfaces);
  return addresses;
}

void check_is_of_this_host(const std::string& address) {
  const std::vector<std::string> own = addresses_of_this_host();
  if (std::find(own.begin(), own.end(), address) != own.end()) return;
  std::string message = "PALPATE_INTERFACES: \"" + address + "\": allowed are the addresses";
  for (const std::string& allowed : own) message.append(" ").append(allowed);
  throw InputError(message);
}

void check_is_address(const std::string& address) {
  in_addr ignored;
  if (inet_pton(AF_INET, address.c_str(), &ignored) == 1) return;
  throw InputError("PALPATE_PEERS: \"" + address +
                   "\": allowed are IPv4 addresses such as 10.0.0.6");
}

template <class Check>
std::vector<std::string> list_of(const char* comma_separated, const Check& check) {
  std::vector<std::string> addresses;
  std::istringstream list(comma_separated == nullptr ? "" : comma_separated);
  for (std::string address; std::getline(list, address, ',');) {
    if (address.empty()) continue;
    check(address);
    addresses.push_back(address);
  }
  return addresses;
}

}  // namespace

std::vector<std::string> addresses_of_this_host() {
  std::vector<std::string> addresses;
  for (auto& each : interface_addresses()) addresses.push_back(std::move(each.address));
  return addresses;
}

bool has_link(const std::string& address) {
  return std::ranges::any_of(interface_addresses(), [&](const InterfaceAddress& each) {
    return each.address == address && each.runs;
  });
}

bool Addresses::over_hosts() const {
  return std::any_of(own.begin(), own.end(),
                     [](const std::string& address) { return !address.starts_with("127."); });
}

Addresses addresses_from(const char* interfaces, const char* peers) {
  Addresses addresses{list_of(interfaces, check_is_of_this_host), list_of(peers, check_is_address)};
  if (addresses.own.empty()) addresses.own.emplace_back("127.0.0.1");
  return addresses;
}

}  // namespace palpate::bus
