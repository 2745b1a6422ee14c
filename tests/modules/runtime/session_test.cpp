#include "modules/runtime/session.h"

#include <catch2/catch.hpp>

#include "modules/bus/dds_bus.h"
#include "modules/bus/memory_bus.h"
#include "modules/runtime/clock.h"
#include "tests/modules/runtime/own_bus.h"

using namespace palpate;
using namespace palpate::runtime;
using palpate::testing::own_bus_options;
using palpate::testing::wait_until;

namespace {

SceneDescription description(const std::string& digest, std::uint32_t version = kProtocolVersion) {
  SceneDescription scene;
  scene.name = "ball";
  scene.digest = digest;
  scene.protocol_version = version;
  return scene;
}

}  // namespace

TEST_CASE("session: a module that joins a running session plays along at once") {
  // Oracle: the giver's own clock.
  const auto options = own_bus_options();
  bus::DdsBus launcher_bus(options), module_bus(options);
  Session launcher(launcher_bus, "d");
  SessionConductor conductor(launcher_bus);
  conductor.command(launcher.state(), SessionCommand::kStart);

  Session module(module_bus, "d");
  CHECK(module.phase() == SessionPhase::kWaiting);
  REQUIRE(wait_until([&] {
    module.poll();
    launcher.poll();
    return module.running() && launcher.running();
  }));
  const auto now = monotonic_now_ns();
  CHECK(module.time(now) == launcher.time(now));
  conductor.command(launcher.state(), SessionCommand::kStop);
  CHECK(wait_until([&] {
    module.poll();
    return module.phase() == SessionPhase::kStopped;
  }));
}

TEST_CASE("session: repeating says the newest command of anybody again") {
  // Oracle: a reader that joins after the person who paused has gone.
  const auto options = own_bus_options();
  bus::DdsBus launcher_bus(options);
  Session launcher(launcher_bus, "d");
  SessionConductor conductor(launcher_bus);
  conductor.command(launcher.state(), SessionCommand::kStart);
  {
    bus::DdsBus person_bus(options);
    Session person(person_bus, "d");
    SessionConductor person_conductor(person_bus);
    REQUIRE(wait_until([&] {
      person.poll();
      return person.running();
    }));
    person_conductor.command(person.state(), SessionCommand::kPause);
    REQUIRE(wait_until([&] {
      launcher.poll();
      return launcher.phase() == SessionPhase::kPaused;
    }));
  }
  conductor.repeat(launcher.state());
  bus::DdsBus late_bus(options);
  Session late(late_bus, "d");
  CHECK(wait_until([&] {
    late.poll();
    return late.phase() == SessionPhase::kPaused;
  }));
}

TEST_CASE("session: an older command said again takes no newer one's place") {
  // Oracle: the command of the latest source time, given by somebody else.
  bus::MemoryBus bus;
  Session launcher(bus, "d"), module(bus, "d");
  SessionConductor conductor(bus), person(bus);
  conductor.command(launcher.state(), SessionCommand::kStart);
  launcher.poll();
  module.poll();
  const SessionState before = launcher.state();
  person.command(before, SessionCommand::kPause);
  conductor.repeat(before);  // who has not heard the person yet
  for (Session* session : {&launcher, &module}) {
    session->poll();
    CHECK(session->phase() == SessionPhase::kPaused);
  }
}

TEST_CASE("session: another scene or protocol is a fault that says what to do") {
  // Oracle: the messages.
  CHECK(scene_mismatch(description("aa"), "aa").empty());
  CHECK(scene_mismatch(description("aa"), "bb") ==
        "the session plays scene 'ball' (digest aa), this module loaded another (digest bb): "
        "start it with the same scene file and meshes");
  CHECK(scene_mismatch(description("aa", kProtocolVersion + 1), "aa") ==
        "the session speaks protocol version " + std::to_string(kProtocolVersion + 1) +
            ", this module " + std::to_string(kProtocolVersion) + ": use programs of one release");
}

TEST_CASE("session: with the wrong scene a module does not run") {
  // Oracle: definition.
  const auto options = own_bus_options();
  bus::DdsBus launcher_bus(options), module_bus(options);
  auto scenes = launcher_bus.writer(bus::kScene);
  Session launcher(launcher_bus, "aa");
  SessionConductor conductor(launcher_bus);
  auto scene = description("aa");
  REQUIRE(scenes.write(scene));
  conductor.command(launcher.state(), SessionCommand::kStart);
  Session module(module_bus, "bb");
  REQUIRE(wait_until([&] {
    module.poll();
    return module.phase() == SessionPhase::kRunning && !module.fault().empty();
  }));
  CHECK_FALSE(module.running());
}
