// A process that returns while the finger is pressed in gives the force back: soon, and without a
// blow. Real processes over loopback; the finger has a real device's type, `topic`.
#include <catch2/catch.hpp>
#include <iostream>

#include "tests/system/running_session.h"

using namespace palpate;
using namespace palpate::testing;

namespace {

constexpr double kBack = 0.9;       // of the force before: it is back
constexpr double kOvershoot = 1.1;  // of the force before
constexpr double kSoon = 1;         // [s], after the process is heard again
constexpr double kCalm = 0.02;      // of the force: what it changes by in half a second, at rest

double seconds_now() { return 1e-9 * double(runtime::monotonic_now_ns()); }

/// Presses to `height` and waits until the force is steady. @returns it [N]
double steady_force(RunningSession& session, double height) {
  session.move_finger(height);
  double force = 0, since = seconds_now();
  REQUIRE(session.wait([&](const Heard& heard) {
    const double now = heard.force.force.norm();
    if (now == 0 || std::abs(now - force) > kCalm * force) {
      force = now;
      since = seconds_now();
    }
    return seconds_now() > since + 0.5;
  }));
  return force;
}

/// When a process that was started at `since` [s] was first heard again [s].
double wait_for_news(RunningSession& session, const std::string& module, std::int64_t since_ns) {
  REQUIRE(session.wait([&](const Heard& heard) {
    const Header& header = module == "deformation" ? heard.nodes.header : heard.contacts.header;
    return header.source_time_ns > since_ns;
  }));
  return seconds_now();
}

}  // namespace

TEST_CASE("returning: a module that died under a pressed finger gives the force back") {
  // Oracle: the force before. The tip is 10 or 2 mm deep, its radius and a fifth of it; the tissue
  // that it was in has come to rest around it.
  const std::string module = GENERATE("deformation", "collision");
  const double height = GENERATE(as<double>{}, kFingerPressing, kFingerPressing + 0.008);
  const BallScene scene{"topic: {start_m: [0, 0, 0.09]}"};
  RunningSession session(scene);
  session.move_finger(kFingerStart);
  REQUIRE(session.start());
  const double before = steady_force(session, height);
  session.kill(module);
  REQUIRE(session.wait([](const Heard& heard) { return heard.force.force.norm() == 0; }));
  const double calm = seconds_now() + 0.5;
  session.wait([&](const Heard&) { return seconds_now() > calm; });

  session.forget_largest();
  const std::int64_t started_ns = runtime::monotonic_now_ns();
  session.start_module(module);
  const double heard_again = wait_for_news(session, module, started_ns);
  REQUIRE(
      session.wait([&](const Heard& heard) { return heard.force.force.norm() > kBack * before; }));
  const double took = seconds_now() - heard_again;
  const double until = seconds_now() + 1;
  session.wait([&](const Heard&) { return seconds_now() > until; });
  const double overshoot = session.heard().largest_force / before;
  const double after = session.heard().force.force.norm();
  std::cout << module << " killed under a tip at " << height << " m: heard again "
            << heard_again - 1e-9 * double(started_ns) << " s after its start, force back " << took
            << " s after that, at most " << overshoot << ", at last " << after / before << " of "
            << before << " N\n";
  CHECK(took < kSoon);
  CHECK(overshoot <= kOvershoot);
  CHECK(std::abs(after / before - 1) < 0.05);
  CHECK(session.heard().largest_force_step <=
        session.scene().haptics.max_force_rate / session.scene().rates.haptics * (1 + 1e-9));
}
