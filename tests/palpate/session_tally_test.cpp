#include "palpate/session_tally.h"

#include <catch2/catch.hpp>

using namespace palpate;
using namespace palpate::launcher;

namespace {

SessionTally some_tally() {
  scene::Scene scene;
  scene.organs.resize(1);
  scene.organs[0].name = "ball";
  scene.probes.resize(2);
  scene.probes[0].name = "left";
  scene.probes[1].name = "right";
  return SessionTally(scene);
}

ModuleStatus status(const char* module, std::uint64_t cycles, std::uint64_t overruns,
                    std::int64_t process = 1) {
  ModuleStatus message;
  message.module = module;
  message.cycles = cycles;
  message.overruns = overruns;
  message.process_id = process;
  message.real_time_factor = 0.9;
  return message;
}

}  // namespace

TEST_CASE("session tally: counts that go back are another's, and sums do not wrap") {
  // Oracle: by hand. One status of 10^15 cycles before the start made 1.8e19 of the session's.
  auto tally = some_tally();
  tally.receive(status("haptics", 1'000'000'000'000'000, 7));
  tally.start();
  tally.receive(status("haptics", 50, 2));
  CHECK(tally.module("haptics")->cycles() == 50);
  CHECK(tally.module("haptics")->overruns() == 2);
  tally.receive(status("haptics", 60, 3));
  CHECK(tally.module("haptics")->cycles() == 60);
}

TEST_CASE("session tally: extremes are those of all processes that came one after the other") {
  // Oracle: by hand.
  auto tally = some_tally();
  tally.start();
  ModuleStatus deformation = status("deformation", 1, 0);
  deformation.organs = {{0, 1.0, 0.005, -10, 40, 7}};
  tally.receive(deformation);
  ModuleStatus successor = status("deformation", 1, 0, 2);
  successor.organs = {{0, 0.999, 0.001, -12, 5, 3}};
  tally.receive(successor);
  const OrganTally& organ = tally.organs()[0];
  CHECK(organ.name == "ball");
  CHECK(organ.volume_ratio == 0.999);
  CHECK(organ.worst_volume_error == 0.005);
  CHECK(organ.lowest_pressure == -12);
  CHECK(organ.highest_pressure == 40);
  CHECK(organ.most_contacts == 7);

  ModuleStatus haptics = status("haptics", 1, 0);
  haptics.probes = {{0, 0.5, 0.5, kForceSaturated, 0.1}, {1, 0.1, 0.1, 0, 0}};
  tally.receive(haptics);
  haptics = status("haptics", 1, 0, 2);
  haptics.probes = {{0, 0.2, 0.3, kForceStaleFade, 0.7}, {1, 0, 0, 0, 0}};
  tally.receive(haptics);
  CHECK(tally.probes()[0].force == 0.2);
  CHECK(tally.probes()[0].greatest_force == 0.5);
  CHECK(tally.probes()[0].error_of_greatest == 0.1);
  CHECK(tally.probes()[0].limits == (kForceSaturated | kForceStaleFade));
  CHECK(tally.probes()[1].greatest_force == 0.1);
}

TEST_CASE("session tally: a module's cycles count from the start, or from its own new start") {
  // Oracle: by hand.
  auto tally = some_tally();
  tally.receive(status("haptics", 500, 20));
  tally.start();
  tally.receive(status("haptics", 1490, 30));
  REQUIRE(tally.module("haptics") != nullptr);
  CHECK(tally.module("haptics")->cycles() == 990);
  CHECK(tally.module("haptics")->overruns() == 10);
  CHECK(tally.module("haptics")->on_time_fraction() == Approx(0.99));
  tally.receive(status("haptics", 100, 0, 2));
  CHECK(tally.module("haptics")->cycles() == 100);
  CHECK(tally.module("collision") == nullptr);
  CHECK(tally.real_time_factor() == 0);
  tally.receive(status("deformation", 1, 0));
  CHECK(tally.real_time_factor() == 0.9);
  auto other = status("deformation_2", 1, 0);
  other.real_time_factor = 0.5;
  tally.receive(other);
  CHECK(tally.real_time_factor() == 0.5);  // of the slower one
}

TEST_CASE("session tally: what a status said while degraded is kept once, with its newest count") {
  // Oracle: the statuses given.
  auto tally = some_tally();
  const auto say = [&](ModuleState state, const std::string& text) {
    auto message = status("deformation", 1, 0);
    message.state = state;
    message.last_error = text;
    tally.receive(message);
  };
  say(ModuleState::kDegraded, "before the start");
  tally.start();
  say(ModuleState::kDegraded, "a probe jumped");
  say(ModuleState::kRunning, "");
  say(ModuleState::kDegraded, "too flat");
  say(ModuleState::kDegraded, "a probe jumped (2 times)");
  say(ModuleState::kStopped, "said at the end");
  CHECK(tally.troubles() ==
        std::vector<std::string>{"deformation: a probe jumped (2 times)", "deformation: too flat"});
}

TEST_CASE("session tally: organs and probes the scene does not have change nothing") {
  // Oracle: definition.
  auto tally = some_tally();
  tally.start();
  ModuleStatus foreign = status("deformation", 1, 0);
  foreign.organs = {{1, 7, 6, 0, 0, 0}};
  foreign.probes = {{2, 5, 5, 0, 0}};
  tally.receive(foreign);
  CHECK(tally.organs()[0].worst_volume_error == 0);
  CHECK(tally.probes()[1].greatest_force == 0);
}

TEST_CASE("session tally: troubles of contacts add up over modules, started again or not") {
  // Oracle: by hand.
  auto tally = some_tally();
  CHECK_FALSE(tally.contact_troubles().any());
  ModuleStatus collision = status("collision", 1, 0, 1), deformation = status("deformation", 1, 0);
  collision.contacts = {1, 2, 0};
  deformation.contacts = {0, 0, 4};
  tally.receive(collision);
  tally.receive(deformation);
  collision.contacts = {8, 2, 0};
  tally.receive(collision);
  ModuleStatus again = status("collision", 1, 0, 2);
  again.contacts = {16, 0, 0};
  tally.receive(again);
  CHECK(tally.contact_troubles().truncated == 24);
  CHECK(tally.contact_troubles().lost == 2);
  CHECK(tally.contact_troubles().unsolved == 4);
  tally.receive(ContactTroubles{100, 0, 0});
  tally.receive(ContactTroubles{200, 0, 0});
  CHECK(tally.contact_troubles().truncated == 224);
}

TEST_CASE("session tally: troubles of two processes that are one module count once each") {
  // Oracle: by hand. Each turn of the two added what they had said so far. Their hosts may have
  // given both the same number.
  for (const std::int64_t number_of_second : {1, 2}) {
    auto tally = some_tally();
    ModuleStatus first = status("collision", 500, 0, 1);
    ModuleStatus second = status("collision", 40, 0, number_of_second);
    first.contacts = {0, 1, 0};
    for (int turn = 0; turn < 10; ++turn) {
      tally.receive(first, bus::WriterId{1});
      tally.receive(second, bus::WriterId{2});
      second.contacts.truncated = 3;
    }
    CHECK(tally.contact_troubles().lost == 1);
    CHECK(tally.contact_troubles().truncated == 3);
  }
}

TEST_CASE("session tally: a pause is no trouble") {
  // Oracle: by hand.
  auto tally = some_tally();
  tally.start();
  ModuleStatus degraded = status("haptics", 10, 0);
  degraded.state = ModuleState::kDegraded;
  degraded.last_error = "contact model older than stale_after_s";
  tally.stands(true);
  tally.receive(degraded);
  CHECK(tally.troubles().empty());
  tally.stands(false);
  tally.receive(degraded);
  CHECK(tally.troubles().size() == 1);
}
