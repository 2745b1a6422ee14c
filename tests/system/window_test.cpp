// The window as a person uses it: a virtual display, real events of mouse and keys (XTEST, by
// xdotool), real processes.
#include <catch2/catch.hpp>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <iostream>

#include "modules/bus/dds_bus.h"
#include "tests/system/launched.h"
#include "visualizer/offscreen_display.h"

using namespace palpate;
using namespace palpate::testing;
using Clock = std::chrono::steady_clock;

namespace {

bool tools_or_skip() {
  for (const char* tool : {"Xvfb", "xdotool"}) {
    if (std::system((std::string("command -v ") + tool + " > /dev/null").c_str()) == 0) continue;
    std::cout << "SKIPPED: " << tool << " is not installed (Debian: xvfb, xdotool)\n";
    return false;
  }
  return true;
}

/// Mouse and keyboard of the display.
struct Hand {
  bool run(const std::string& words) const {
    return std::system(("xdotool " + words + " > /dev/null 2>&1").c_str()) == 0;
  }
  bool find_window(const std::string& title) const {
    return wait_until([&] { return run("search --name '^" + title + "$' windowfocus"); });
  }
  void press_at(int x, int y) const {
    run("mousemove " + std::to_string(x) + " " + std::to_string(y) + " mousedown 1");
  }
  void drag(int x, int y) const {
    run("mousemove_relative -- " + std::to_string(x) + " " + std::to_string(y));
  }
  void let_go() const { run("mouseup 1"); }
  void key(const std::string& name) const { run("key " + name); }
};

/// A run with a window, and what its bus says.
struct Windowed {
  explicit Windowed(const std::filesystem::path& scene, std::vector<std::string> more = {})
      : options(own_bus_options()),
        bus(options),
        forces(bus.reader(bus::kHapticForce)),
        commands(bus.reader(bus::kSessionControl)),
        run(bin("palpate"), arguments(scene, std::move(more), options)) {}

  static std::vector<std::string> arguments(const std::filesystem::path& scene,
                                            std::vector<std::string> more,
                                            const bus::BusOptions& options) {
    more.insert(more.begin(), {"run", scene.string()});
    return joined(std::move(more), options);
  }
  double force() {
    while (forces.take(newest)) {
    }
    return newest.force.norm();
  }
  /// Of the session [s].
  double time() {
    force();
    return 1e-9 * static_cast<double>(newest.header.sim_time_ns);
  }
  bool heard(SessionCommand awaited) {
    return wait_until([&] {
      SessionControl command;
      while (commands.take(command)) {
        if (command.command == awaited) return true;
      }
      return false;
    });
  }

  visualizer::OffscreenDisplay display;
  bus::BusOptions options;
  bus::DdsBus bus;
  bus::Reader<HapticForce> forces;
  bus::Reader<SessionControl> commands;
  Running run;
  Hand hand;
  HapticForce newest;
};

}  // namespace

TEST_CASE("window: one drag from the start to a force, keys conduct, q ends the run") {
  // Oracle: the force that haptics renders, the commands on the bus, the exit code. The time from
  // the window to the force is printed: a shared machine proves nothing by it.
  if (!tools_or_skip()) return;
  Windowed session(PALPATE_SOURCE_DIR "/scenes/press_me.yaml");
  REQUIRE(session.hand.find_window("Palpate: press_me"));
  const auto shown = Clock::now();
  REQUIRE(session.heard(SessionCommand::kStart));
  const auto started = Clock::now();
  // A press before the organ is in the picture turns the camera: it is pressed until it is felt.
  const auto pressed = [&] {
    session.hand.press_at(400, 360);
    for (int i = 0; i < 10; ++i) session.hand.drag(5, 4);
    if (wait_until([&] { return session.force() > 0.05; }, 3)) return true;
    session.hand.let_go();
    session.hand.key("Home");
    return false;
  };
  int drags = 1;
  while (!pressed()) REQUIRE(++drags < 5);
  const auto felt = Clock::now();
  const auto seconds = [](auto duration) {
    return std::chrono::duration<double>(duration).count();
  };
  std::printf(
      "window: a force of %.2f N after %d drag(s), %.1f s after the window was there, %.1f s after "
      "the session's start\n",
      session.force(), drags, seconds(felt - shown), seconds(felt - started));
  const double before = session.force();
  for (int i = 0; i < 10; ++i) session.hand.drag(4, 3);
  CHECK(wait_until([&] { return session.force() > 1.2 * before; }));
  session.hand.let_go();
  CHECK(wait_until([&] { return session.force() == 0; }));

  session.hand.key("space");
  CHECK(session.heard(SessionCommand::kPause));
  session.hand.key("n");
  CHECK(session.heard(SessionCommand::kStep));
  session.hand.key("space");
  CHECK(session.heard(SessionCommand::kStart));
  session.hand.key("m");
  CHECK(session.heard(SessionCommand::kStep));
  // A quarter of real time where pictures come in time, less where they do not.
  const auto slow = Clock::now();
  const double from = session.time();
  CHECK(wait_until([&] { return session.time() > from + 0.3; }));
  CHECK(session.time() - from < 0.5 * seconds(Clock::now() - slow));
  session.hand.key("m");
  CHECK(session.heard(SessionCommand::kStart));
  session.hand.key("q");
  CHECK(session.run.wait_for_end() == 0);
  INFO(session.run.said());
  CHECK(session.run.said().find("probe fingertip") != std::string::npos);
  CHECK(session.run.said().find("its window stays") == std::string::npos);
}

TEST_CASE("window: stays when the run has ended, with the summary said, until q") {
  // Oracle: the launcher's words and its exit.
  if (!tools_or_skip()) return;
  const BallScene scene(
      "scripted: {start_m: [0, 0, 0.07], moves: [{to_m: [0, 0, 0.05], duration_s: 1}]}");
  Windowed session(scene.file(), {"--duration", "1.5"});
  REQUIRE(session.hand.find_window("Palpate: press"));
  REQUIRE(session.run.wait_for_text("its window stays until q closes it"));
  CHECK(session.run.said().find("probe finger") != std::string::npos);
  CHECK_FALSE(wait_until([&] { return session.run.child().ended().has_value(); }, 0.5));
  session.hand.key("q");
  CHECK(session.run.wait_for_end() == 0);
}

TEST_CASE("window: stays when a lockstep has ended, too, until q or with --close not at all") {
  // Oracle: the launcher's words and its exit.
  if (!tools_or_skip()) return;
  const BallScene scene(
      "scripted: {start_m: [0, 0, 0.07], moves: [{to_m: [0, 0, 0.05], duration_s: 1}]}");
  {
    Windowed session(scene.file(), {"--duration", "0.5", "--lockstep"});
    REQUIRE(session.run.wait_for_text("its window stays until q closes it"));
    CHECK(session.run.said().find("probe finger") != std::string::npos);
    CHECK_FALSE(wait_until([&] { return session.run.child().ended().has_value(); }, 0.5));
    REQUIRE(session.hand.find_window("Palpate: press"));
    session.hand.key("q");
    CHECK(session.run.wait_for_end() == 0);
  }
  constexpr double kClosedDeadline = 60;  // [s]; of a busy machine
  Windowed closed(scene.file(), {"--duration", "0.5", "--lockstep", "--close"});
  CHECK(closed.run.wait_for_end(kClosedDeadline) == 0);
  CHECK(closed.run.said().find("its window stays") == std::string::npos);
}

TEST_CASE("window: a script is taken over by a drag, and --close ends with the run") {
  // Oracle: a script far from the ball feels nothing by itself.
  if (!tools_or_skip()) return;
  const BallScene scene(
      "scripted: {start_m: [0, 0, 0.07], moves: [{to_m: [0, 0, 0.08], duration_s: 1}]}");
  Windowed session(scene.file(), {"--duration", "12", "--close"});
  REQUIRE(session.hand.find_window("Palpate: press"));
  REQUIRE(session.heard(SessionCommand::kStart));
  bool felt = false;
  for (int drag = 0; drag < 4 && !felt; ++drag) {
    session.hand.press_at(460, 360);
    for (int i = 0; i < 10; ++i) session.hand.drag(6, 6);
    felt = wait_until([&] { return session.force() > 0.02; }, 2);
    if (!felt) session.hand.let_go();
  }
  CHECK(felt);
  session.hand.let_go();
  CHECK(session.run.wait_for_end() == 0);
}
