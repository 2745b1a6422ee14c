#include "modules/bus/addresses.h"

#include <catch2/catch.hpp>

#include "modules/core/error.h"

namespace palpate::bus {
namespace {

using List = std::vector<std::string>;

std::string refusal(const char* interfaces, const char* peers) {
  try {
    addresses_from(interfaces, peers);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

}  // namespace

TEST_CASE("addresses: from comma-separated lists, else loopback and no peers", "[bus]") {
  // Oracle: lists by hand; every host has 127.0.0.1.
  const std::string loopback("127.0.0.1");
  CHECK(addresses_from(nullptr, nullptr).own == List{loopback});
  CHECK(addresses_from("", "").own == List{loopback});
  CHECK(addresses_from("127.0.0.1,,127.0.0.1", nullptr).own == List{loopback, loopback});
  CHECK(addresses_from(nullptr, nullptr).peers.empty());
  CHECK(addresses_from("", "10.0.0.6,,10.0.0.7").peers == List{"10.0.0.6", "10.0.0.7"});
}

TEST_CASE("addresses: an address that this host does not have is refused by name", "[bus]") {
  // Oracle: 240.0.0.1 is reserved; no host has it.
  for (const std::string& bad : {std::string("240.0.0.1"), std::string("eth0")}) {
    std::string expected("PALPATE_INTERFACES: \"");
    expected.append(bad).append("\": allowed are the addresses ");
    const std::string list = std::string("127.0.0.1,").append(bad);
    CHECK(refusal(list.c_str(), nullptr).substr(0, expected.size()) == expected);
  }
}

TEST_CASE("addresses: a peer that is no address is refused by name", "[bus]") {
  // Oracle: texts by hand.
  for (const std::string& bad :
       {std::string("lab-pc"), std::string("10.0.0"), std::string("::1")}) {
    std::string expected("PALPATE_PEERS: \"");
    expected.append(bad).append("\": allowed are IPv4 addresses such as 10.0.0.6");
    CHECK(refusal(nullptr, bad.c_str()) == expected);
  }
}

}  // namespace palpate::bus
