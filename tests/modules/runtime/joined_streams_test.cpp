#include "modules/runtime/joined_streams.h"

#include <catch2/catch.hpp>

#include "modules/bus/dds_bus.h"
#include "tests/modules/runtime/own_bus.h"

using namespace palpate;
using namespace palpate::runtime;
using palpate::testing::own_bus_options;
using palpate::testing::wait_until;

namespace {

scene::Scene scene_of(std::size_t processes) {
  scene::Scene scene;
  scene.organs.resize(processes);
  for (std::size_t i = 0; i < processes; ++i) scene.organs[i].process = i + 1;
  return scene;
}

}  // namespace

TEST_CASE("joined streams: haptics waits for all who give laws, and all who hear of its probes") {
  // Oracle: session_wires(): laws come from each deformation process, probes are heard by them and
  // by collision. What may never come is not waited for: laws themselves, a driver's input.
  const scene::Scene one = scene_of(1), two = scene_of(2);
  const bus::BusOptions options = own_bus_options();
  bus::DdsBus own(options), others(options);
  auto laws = own.reader(bus::kContactModel);
  auto inputs = own.reader(bus::kProbeInput);
  auto probes = own.writer(bus::kProbeState);
  auto forces = own.writer(bus::kHapticForce);
  CHECK_FALSE(are_streams_joined(own, one, "haptics"));
  auto of_deformation = others.writer(bus::kContactModel);
  auto to_deformation = others.reader(bus::kProbeState);
  REQUIRE(wait_until([&] { return laws.matched_writers() == 1 && probes.matched_readers() == 1; }));
  CHECK_FALSE(are_streams_joined(own, one, "haptics"));
  auto to_collision = others.reader(bus::kProbeState);
  CHECK(wait_until([&] { return are_streams_joined(own, one, "haptics"); }));
  CHECK_FALSE(are_streams_joined(own, two, "haptics"));
  CHECK(are_streams_joined(own, one, "visualizer"));
}

TEST_CASE("joined streams: what is said before a session runs has been heard") {
  // Oracle: definition; a writer that is known may not know its reader yet.
  const scene::Scene scene = scene_of(1);
  const bus::BusOptions options = own_bus_options();
  bus::DdsBus own(options), others(options);
  auto probes = own.reader(bus::kProbeState);
  auto of_haptics = others.writer(bus::kProbeState);
  REQUIRE(wait_until(
      [&] { return probes.matched_writers() == 1 && of_haptics.matched_readers() == 1; }));
  CHECK_FALSE(are_streams_joined(own, scene, "collision"));
  ProbeState state;
  CHECK(wait_until([&] {
    of_haptics.write(state);
    while (probes.take(state)) {
    }
    return are_streams_joined(own, scene, "collision");
  }));
}
