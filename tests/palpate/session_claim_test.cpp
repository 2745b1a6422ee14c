#include "palpate/session_claim.h"

#include <catch2/catch.hpp>
#include <optional>

#include "modules/core/error.h"
#include "tests/modules/runtime/own_bus.h"

using namespace palpate;
using launcher::SessionClaim;

TEST_CASE("session claim: a session has one launcher, and is free when that is gone") {
  // Oracle: the kernel's names.
  const bus::BusOptions own = palpate::testing::own_bus_options();
  std::optional<SessionClaim> first(std::in_place, own.session, own.domain);
  CHECK_THROWS_WITH(SessionClaim(own.session, own.domain),
                    Catch::Contains("session '" + own.session + "' already runs here"));
  CHECK_NOTHROW(SessionClaim(own.session, own.domain + 1));
  CHECK_NOTHROW(SessionClaim(own.session + "b", own.domain));
  first.reset();
  CHECK_NOTHROW(SessionClaim(own.session, own.domain));
}
