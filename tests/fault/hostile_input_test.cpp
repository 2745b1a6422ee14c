// What comes from outside is not to be trusted: not finite poses, wrong scenes, foreign probes.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <limits>

#include "modules/bus/dds_bus.h"
#include "tests/system/running_session.h"

using namespace palpate;
using namespace palpate::testing;

namespace {

/// ProbeState in little-endian CDR: encapsulation, four 8-byte header fields, key, padding, 13
/// doubles, buttons. Written by hand, because our own writer refuses what is not finite.
std::vector<std::uint8_t> probe_state_payload(std::uint32_t probe, const double (&pose)[7],
                                              double speed = 0) {
  std::vector<std::uint8_t> bytes(4 + 148);
  bytes[1] = 0x01;  // CDR, little-endian
  std::size_t at = 4;
  const auto append = [&](auto value) {
    std::memcpy(bytes.data() + at, &value, sizeof value);
    at += sizeof value;
  };
  append(std::uint64_t{1});
  append(std::int64_t{0});
  append(runtime::monotonic_now_ns());
  append(std::uint64_t{0});  // the bus writes its own
  append(probe);
  append(std::uint32_t{0});
  for (const double value : pose) append(value);
  for (int i = 0; i < 6; ++i) append(speed);
  append(std::uint32_t{0});
  return bytes;
}

std::uint64_t refused_inputs(const Heard& heard) {
  for (const auto& input : heard.modules.at("haptics").inputs) {
    if (input.topic == bus::kProbeInput.name) return input.rejected;
  }
  return 0;
}

bool all_finite(const Heard& heard) {
  bool finite = heard.force.force.allFinite() && heard.probe.pose.position.allFinite();
  for (const float x : heard.nodes.positions) finite = finite && std::isfinite(x);
  return finite;
}

}  // namespace

TEST_CASE("hostile input: a pose that is not a number is refused, counted and goes no further") {
  // Oracle: status, and every number that leaves the processes.
  const BallScene scene;
  RunningSession session(scene);
  REQUIRE(session.start());
  REQUIRE(session.press(0.05));
  bus::DdsBus attackers(session.options());
  const auto attacker = attackers.raw_writer(bus::info_of(bus::kProbeInput));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  bool finite = true;
  CHECK(session.wait([&](const Heard& heard) {
    attacker->write(probe_state_payload(0, {nan, 0, 0.05, 0, 0, 0, 1}));
    attacker->write(probe_state_payload(0, {0, 0, infinity, 0, 0, 0, 1}));
    attacker->write(probe_state_payload(0, {0, 0, 0.05, 0, 0, 0, 0}));
    finite = finite && all_finite(heard);
    return refused_inputs(heard) > 10;
  }));
  CHECK(finite);
  CHECK(session.wait([&](const Heard& heard) { return heard.force.force.norm() > 0.05; }));
  CHECK(all_finite(session.heard()));
}

TEST_CASE("hostile input: finite numbers that no probe has end nobody") {
  // Oracle: the processes go on. A speed of 1e308 overflowed into an assertion of the search.
  const BallScene scene;
  RunningSession session(scene);
  REQUIRE(session.start());
  REQUIRE(session.press(0.05));
  bus::DdsBus attackers(session.options());
  const auto to_collision = attackers.raw_writer(bus::info_of(bus::kProbeState));
  const auto to_haptics = attackers.raw_writer(bus::info_of(bus::kProbeInput));
  const std::uint64_t then = session.heard().nodes.header.sequence;
  bool finite = true;
  CHECK(session.wait([&](const Heard& heard) {
    for (const double size : {1e308, 1e200, 1.1e30, 1e30, 1e12, 1e6, 1e3}) {
      for (const double speed : {size, -size}) {
        to_collision->write(probe_state_payload(0, {0, 0, 0.05, 0, 0, 0, 1}, speed));
        to_haptics->write(probe_state_payload(0, {speed, 0, 0.05, 0, 0, 0, 1}, speed));
      }
    }
    finite = finite && all_finite(heard);
    return heard.nodes.header.sequence > then + 250;
  }));
  CHECK(finite);
  for (const char* name : {"deformation", "collision", "haptics"}) {
    CHECK_FALSE(session.child(name).ended().has_value());
  }
}

TEST_CASE("hostile input: the same bytes with finite numbers do move the probe") {
  // Oracle: the test above would prove nothing with a payload that is wrong in another way.
  const BallScene scene;
  RunningSession session(scene);
  REQUIRE(session.start());
  bus::DdsBus drivers(session.options());
  const auto driver = drivers.raw_writer(bus::info_of(bus::kProbeInput));
  CHECK(session.wait([&](const Heard& heard) {
    driver->write(probe_state_payload(0, {0.1, 0.02, 0.08, 0, 0, 0, 1}));
    return (heard.probe.pose.position - Vec3(0.1, 0.02, 0.08)).norm() < 1e-3;
  }));
}

TEST_CASE("hostile input: probes that the scene does not have are nobody's") {
  // Oracle: the finger stays where it is.
  const BallScene scene;
  RunningSession session(scene);
  REQUIRE(session.start());
  bus::DdsBus drivers(session.options());
  const auto driver = drivers.raw_writer(bus::info_of(bus::kProbeInput));
  const auto taken = [](const Heard& heard) {
    for (const auto& input : heard.modules.at("haptics").inputs) {
      if (input.topic == bus::kProbeInput.name) return input.received;
    }
    return std::uint64_t{0};
  };
  REQUIRE(session.wait([&](const Heard& heard) {
    driver->write(probe_state_payload(7, {0, 0, 0.05, 0, 0, 0, 1}));
    return taken(heard) > 10;
  }));
  CHECK(session.heard().probe.pose.position.z() == Approx(kFingerStart));
  CHECK(session.heard().modules.at("haptics").state == ModuleState::kRunning);
}

TEST_CASE("hostile input: a module with another scene refuses to play along") {
  // Oracle: state and message of its status.
  const BallScene scene, other("topic: {start_m: [0, 0, 0.2]}");
  RunningSession session(scene);
  bus::DdsBus bus(session.options());
  auto scenes = bus.writer(bus::kScene);
  SceneDescription description;
  description.name = "press";
  description.digest = scene::scene_digest(scene::load_scene(other.file()));
  description.resolved_text = "";
  REQUIRE(scenes.write(description));
  session.start_module("haptics");
  CHECK(session.wait([](const Heard& heard) {
    const auto found = heard.modules.find("haptics");
    return found != heard.modules.end() && found->second.state == ModuleState::kFault &&
           found->second.last_error.find("this module loaded another") != std::string::npos;
  }));
}
