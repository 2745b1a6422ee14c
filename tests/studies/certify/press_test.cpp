#include "studies/certify/press.h"

#include <catch2/catch.hpp>

#include "tests/studies/certify/subjects.h"

using namespace palpate;
using namespace palpate::testing;
using namespace palpate::certify;

namespace {

/// A scene whose passivity control is told of so much damping that it never acts.
Subject without_passivity() {
  Subject subject = wall_subject();
  subject.scene.haptics.device_damping = 50;
  return subject;
}

}  // namespace

TEST_CASE("certify press: a lossless wall gives back what the formula allows, no more") {
  // Oracle: analytic, K v D (T + 2 t_d) (docs/haptic_safety.md). With nothing to control it the
  // leak is there, beside what contact damping takes: between a tenth of the limit and the limit,
  // for v is the largest speed of a minimum-jerk motion and D the depth of the hand's target.
  const Subject subject = without_passivity();
  const auto ticks = press_and_release(loop_on_wall(subject.scene, 200), subject, kGoOn);
  const Line line = energy_line("g", "n", ticks, subject);
  INFO(text_of(line));
  CHECK(line.verdict == Verdict::kPass);
  const double leak = line.value + 1e3 * taken_by_damping(ticks, 1e-3);
  CHECK(leak > 0.1 * line.limit);
  CHECK(leak < line.limit);
}

TEST_CASE("certify press: a delay that nobody was told of fails the line of energy") {
  // Oracle: the same formula with the true delay, 10 ms both ways: 21 times as much.
  const Subject told = without_passivity();
  Subject subject = told;
  subject.device.transport_delay = 5e-3;
  const auto ticks = press_and_release(loop_on_wall(subject.scene, 200), subject, kGoOn);
  CHECK(energy_line("g", "n", ticks, told).verdict == Verdict::kFail);
  CHECK(energy_line("g", "n", ticks, subject).verdict == Verdict::kPass);
}

TEST_CASE("certify press: steps count from the first force, and against what is felt") {
  // Oracle: definition, on ticks made by hand.
  std::vector<Tick> ticks(100);
  for (std::size_t i = 0; i < ticks.size(); ++i) ticks[i].time = 1e-3 * static_cast<double>(i);
  CHECK(first_contact_line("g", "n", ticks).verdict == Verdict::kNotMeasured);
  CHECK(largest_step_line("g", "n", ticks).verdict == Verdict::kNotMeasured);
  ticks[50].step = 0.04;
  ticks[80].step = 0.06;  // 30 ms later
  CHECK(first_contact_line("g", "n", ticks).verdict == Verdict::kPass);
  CHECK(largest_step_line("g", "n", ticks).verdict == Verdict::kFail);
  ticks[80].force = 1.3;
  CHECK(largest_step_line("g", "n", ticks).verdict == Verdict::kPass);
  ticks[60].step = 0.051;
  CHECK(first_contact_line("g", "n", ticks).verdict == Verdict::kFail);
}
