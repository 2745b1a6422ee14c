#include "palpate/session/contact_line.h"

#include <catch2/catch.hpp>

TEST_CASE("contact line: tells all three counts, and says so where there is none") {
  // Oracle: the numbers given.
  using palpate::session::contact_line;
  CHECK(
      contact_line({3, 2, 1}) ==
      "contacts: 3 searches truncated, 2 with a probe inside without contact, 1 steps not solved");
  CHECK(
      contact_line({}) ==
      "contacts: 0 searches truncated, 0 with a probe inside without contact, 0 steps not solved");
}
