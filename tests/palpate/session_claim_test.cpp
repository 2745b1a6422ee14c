#include "palpate/session_claim.h"

#include <catch2/catch.hpp>
#include <chrono>
#include <optional>
#include <thread>

#include "modules/core/error.h"
#include "tests/modules/runtime/own_bus.h"

using namespace palpate;
using launcher::SessionClaim;

namespace {

const std::vector<std::string> kWholeSession{"deformation", "collision", "haptics", "visualizer"};

}  // namespace

TEST_CASE("session claim: a session has one launcher, and is free when that is gone") {
  // Oracle: the kernel's names.
  const bus::BusOptions own = palpate::testing::own_bus_options();
  std::optional<SessionClaim> first(std::in_place, own.session, own.domain, kWholeSession);
  CHECK_THROWS_WITH(SessionClaim(own.session, own.domain, kWholeSession),
                    Catch::Contains("session '" + own.session + "' already runs here"));
  CHECK_NOTHROW(SessionClaim(own.session, own.domain + 1, kWholeSession));
  CHECK_NOTHROW(SessionClaim(own.session + "b", own.domain, kWholeSession));
  first.reset();
  CHECK_NOTHROW(SessionClaim(own.session, own.domain, kWholeSession));
}

TEST_CASE(
    "session claim: who joins has its modules alone, viewers apart, and keeps a whole one out") {
  // Oracle: the kernel's names; the words.
  const bus::BusOptions own = palpate::testing::own_bus_options();
  using Names = std::vector<std::string>;
  const auto join = [&](const Names& modules) {
    return SessionClaim::joining(own.session, own.domain, modules);
  };
  {
    const SessionClaim part = join({"collision", "visualizer"});
    CHECK_THROWS_WITH(SessionClaim(own.session, own.domain, kWholeSession),
                      Catch::Contains("session '" + own.session + "' has collision here already"));
    CHECK_THROWS_WITH(join({"haptics", "collision"}),
                      Catch::Contains("has collision here already"));
    CHECK_NOTHROW(join({"haptics", "visualizer"}));
    CHECK_NOTHROW(SessionClaim(own.session, own.domain, {"deformation", "haptics"}));
  }
  SessionClaim whole(own.session, own.domain, kWholeSession);
  CHECK_THROWS_WITH(join({"collision"}), Catch::Contains("has collision here already"));
  CHECK_NOTHROW(join({"visualizer"}));
  whole.release("collision");  // it has failed for good
  CHECK_NOTHROW(join({"collision"}));
}

TEST_CASE("session claim: a launcher leaves alone what somebody started by hand") {
  // Oracle: the kernel's names; the words. Whoever ends soon is waited for.
  const bus::BusOptions own = palpate::testing::own_bus_options();
  auto haptics = runtime::claim_module(own, "haptics");
  CHECK_THROWS_WITH(SessionClaim(own.session, own.domain, kWholeSession),
                    Catch::Contains("session '" + own.session + "' has haptics here already"));
  CHECK_NOTHROW(SessionClaim::joining(own.session, own.domain, {"deformation", "collision"}));
  std::thread ends([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    haptics.reset();
  });
  CHECK_NOTHROW(SessionClaim(own.session, own.domain, kWholeSession));
  ends.join();
}
