#include "modules/bus/interfaces.h"

#include <catch2/catch.hpp>

#include "modules/core/error.h"

namespace palpate::bus {

TEST_CASE("interfaces: from a comma-separated list, else loopback", "[bus]") {
  // Oracle: lists by hand; every host has 127.0.0.1.
  using List = std::vector<std::string>;
  const std::string loopback("127.0.0.1");
  CHECK(interfaces_from(nullptr) == List{loopback});
  CHECK(interfaces_from("") == List{loopback});
  CHECK(interfaces_from("127.0.0.1,,127.0.0.1") == List{loopback, loopback});
}

TEST_CASE("interfaces: an address that this host does not have is refused by name", "[bus]") {
  // Oracle: 240.0.0.1 is reserved; no host has it.
  const auto message_of = [](const char* list) -> std::string {
    try {
      interfaces_from(list);
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  const std::string allowed("\": allowed are the addresses ");
  for (const std::string& bad : {std::string("240.0.0.1"), std::string("eth0")}) {
    const std::string list = std::string("127.0.0.1,").append(bad);
    std::string expected("PALPATE_INTERFACES: \"");
    expected.append(bad).append(allowed);
    CHECK(message_of(list.c_str()).substr(0, expected.size()) == expected);
  }
}

}  // namespace palpate::bus
