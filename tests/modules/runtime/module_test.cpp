#include "modules/runtime/module.h"

#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <iostream>
#include <string>
#include <thread>

#include "modules/runtime/clock.h"
#include "modules/runtime/realtime.h"
#include "modules/scene/scene_reader.h"
#include "tests/modules/runtime/own_bus.h"

using namespace palpate;
using namespace palpate::runtime;
using palpate::testing::own_bus_options;

namespace {

/// A module of a scene that nobody loads meshes for, with someone who gives it commands.
struct Played {
  explicit Played(bool with_priority = false, bool joining = false)
      : realtime(with_priority), joins(joining) {}

  bool realtime, joins;
  ModuleOptions options = [this] {
    ModuleOptions made;
    made.bus = own_bus_options();
    made.realtime = realtime;
    made.joins = joins;
    return made;
  }();
  scene::Scene scene;
  Module module{options, scene, "haptics", 200, Priority::kPreferred};
  bus::DdsBus bus{options.bus};
  Session session{bus, scene::scene_digest(scene)};
  SessionConductor conductor{bus};
  bus::Reader<ModuleStatus> statuses = bus.reader(bus::kModuleStatus);
  ModuleStatus newest;

  /// Busy, as far as the loop knows, until just before its next period.
  void spend_the_period() const {
    std::this_thread::sleep_until(
        std::chrono::steady_clock::time_point(std::chrono::nanoseconds(module.now_ns())) +
        std::chrono::microseconds(4900));
  }
  bool hogging = false;

  /// Of the process' other threads with real-time priority, the lowest; 0: there are none.
  static int lowest_of_others() {
    int lowest = 0;
    for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
      const pid_t thread = std::stoi(task.path().filename());
      sched_param of_thread{};
      if (thread == gettid() || sched_getscheduler(thread) != SCHED_FIFO) continue;
      sched_getparam(thread, &of_thread);
      lowest = lowest == 0 ? of_thread.sched_priority : std::min(lowest, of_thread.sched_priority);
    }
    return lowest;
  }

  void command(SessionCommand wanted) {
    session.poll();
    conductor.command(session.state(), wanted);
  }
  /// Cycles until the status says so; false after the deadline or if the loop ended.
  bool cycle_until(ModuleState state, std::string_view error = "") {
    const auto deadline = monotonic_now_ns() + 20'000'000'000;
    while (monotonic_now_ns() < deadline && module.next_cycle()) {
      if (hogging) spend_the_period();
      while (statuses.take(newest)) {
      }
      session.poll();
      if (newest.state == state && newest.last_error == error) return true;
    }
    return false;
  }
};

}  // namespace

TEST_CASE("module: its state follows loading, session and guards") {
  // Oracle: the states of messages.h.
  Played played;
  CHECK(played.cycle_until(ModuleState::kStarting));
  played.module.ready();
  CHECK(played.cycle_until(ModuleState::kReady));
  CHECK_FALSE(played.module.running());
  played.command(SessionCommand::kStart);
  CHECK(played.cycle_until(ModuleState::kRunning));
  CHECK(played.module.running());
  played.module.set_guard("an input is stale");
  CHECK(played.cycle_until(ModuleState::kDegraded, "an input is stale"));
  played.module.set_guard("");
  CHECK(played.cycle_until(ModuleState::kRunning));
  played.command(SessionCommand::kPause);
  CHECK(played.cycle_until(ModuleState::kPaused));
  const double paused_at = played.module.time();
  REQUIRE(played.module.next_cycle());
  CHECK(played.module.time() == paused_at);
}

TEST_CASE("module: a stop of the session or a signal ends the loop") {
  // Oracle: definition.
  Played played;
  played.module.ready();
  REQUIRE(played.cycle_until(ModuleState::kReady));
  SECTION("session") { played.command(SessionCommand::kStop); }
  SECTION("signal") { raise(SIGTERM); }
  const auto deadline = monotonic_now_ns() + 20'000'000'000;
  bool going = true;
  while (going && monotonic_now_ns() < deadline) going = played.module.next_cycle();
  CHECK_FALSE(going);
}

TEST_CASE("module: real-time priority is that of who runs, not of who loads or waits") {
  // Oracle: the kernel's word; where it grants none, none is taken.
  const bool granted = request_realtime(20, false).priority;
  give_up_realtime();
  Played played(true);
  CHECK(sched_getscheduler(0) == SCHED_OTHER);
  played.module.ready();
  REQUIRE(played.cycle_until(ModuleState::kReady));
  CHECK(sched_getscheduler(0) == SCHED_OTHER);
  played.command(SessionCommand::kStart);
  REQUIRE(played.cycle_until(ModuleState::kRunning));
  CHECK(sched_getscheduler(0) == (granted ? SCHED_FIFO : SCHED_OTHER));
  if (granted) {  // a busy loop keeps nobody from hearing
    sched_param own{};
    sched_getparam(0, &own);
    CHECK(Played::lowest_of_others() > own.sched_priority);
  }
  give_up_realtime();
}

TEST_CASE(
    "module: a loop that is busy all the time gives its priority back, by what it does with it") {
  // Oracle: the kernel's word.
  if (!request_realtime(20, false).priority) {
    std::cout << "SKIPPED: no real-time priority here\n";
    return;
  }
  give_up_realtime();
  Played played(true);
  played.module.ready();
  played.hogging = true;  // before it has the priority, when this may be others' doing
  REQUIRE(played.cycle_until(ModuleState::kReady));
  for (int k = 0; k < 60; ++k) {
    REQUIRE(played.module.next_cycle());
    played.spend_the_period();
  }
  played.command(SessionCommand::kStart);
  REQUIRE(played.cycle_until(ModuleState::kRunning));
  CHECK(sched_getscheduler(0) == SCHED_FIFO);
  CHECK(palpate::testing::wait_until([&] {
    const bool going = played.module.next_cycle();
    played.spend_the_period();
    return going && sched_getscheduler(0) == SCHED_OTHER;
  }));
  give_up_realtime();
}

TEST_CASE("module: says goodbye") {
  // Oracle: its last status.
  const auto options = own_bus_options();
  bus::DdsBus bus(options);
  auto statuses = bus.reader(bus::kModuleStatus);
  ModuleStatus newest;
  {
    ModuleOptions module_options;
    module_options.bus = options;
    module_options.realtime = false;
    Module module(module_options, scene::Scene{}, "collision", 100, Priority::kPreferred);
    REQUIRE(
        palpate::testing::wait_until([&] { return module.next_cycle() && statuses.take(newest); }));
  }
  CHECK(palpate::testing::wait_until(
      [&] { return statuses.take(newest) && newest.state == ModuleState::kStopped; }));
}

TEST_CASE("module: who joins a session that runs knows its time in the first cycle") {
  // Oracle: definition. The command waits for whoever comes to hear it, as in a session.
  Played played(false, true);
  SECTION("of a session that runs") {
    played.command(SessionCommand::kStart);
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    REQUIRE(played.module.next_cycle());
    CHECK(played.module.running());
    CHECK(played.module.time() >= 0.05);
    CHECK(played.module.joined());
  }
  SECTION("of one that nobody conducts, a second later") {
    const auto began_ns = monotonic_now_ns();
    REQUIRE(played.module.next_cycle());
    CHECK_FALSE(played.module.running());
    CHECK(monotonic_now_ns() - began_ns > 500'000'000);
    CHECK_FALSE(played.module.joined());
  }
}

TEST_CASE("module: messages carry the cycle's time") {
  // Oracle: definition.
  Played played;
  REQUIRE(played.module.next_cycle());
  const Header header = played.module.header();
  CHECK(header.source_time_ns == played.module.now_ns());
  CHECK(header.sim_time_ns == 0);
  CHECK(played.module.period() == Approx(0.005));
}
