#include "studies/rigs/wall_stage.h"

#include <catch2/catch.hpp>

#include "modules/bus/memory_bus.h"

using namespace palpate;

TEST_CASE("wall stage: its law presses below z = 0, and waits above") {
  // Oracle: definition, f = −K z.
  bus::MemoryBus bus{true};
  rigs::WallStage wall(bus, 200, true);
  auto states = bus.writer(bus::kProbeState);
  auto laws = bus.reader(bus::kContactModel);
  ContactModel law;
  for (const double z : {-0.01, 0.002}) {
    ProbeState state;
    state.pose.position.z() = z;
    states.write(state);
    wall.cycle({});
    REQUIRE(laws.take(law));
    CHECK(law.force().z() == Approx(z < 0 ? 2 : 0));
    CHECK(law.rows[0].gap == Approx(z < 0 ? 0 : 0.002));
    CHECK(law.anchor.position.z() == Approx(z));
    CHECK(law.compliance[0] == Approx(1. / 200));
  }
}
