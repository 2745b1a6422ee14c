// Signals made by hand, each with one thing wrong.
#include "studies/stability/verdict.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

namespace palpate::stability {
namespace {

constexpr int kSteps = 100;

/// A swing of energy 1 that keeps energy and volume.
Signals calm() {
  Signals signals;
  signals.energy.assign(kSteps, 1);
  signals.kinetic.assign(kSteps, 0.5);
  signals.turning.assign(kSteps, -0.99);
  signals.volume_error.assign(kSteps, 1e-6);
  signals.displacement.assign(kSteps, 0.01);
  return signals;
}

const Tolerance kTolerance{1, 0.1, 0.01};

State state_of(const Signals& signals) { return judge(signals, kTolerance).state; }

TEST_CASE("verdict: a calm swing is stable, and its numbers are those of the signals") {
  // Oracle: the definition.
  auto signals = calm();
  signals.energy[7] = 1.5;
  signals.displacement[30] = 0.4;
  const Verdict verdict = judge(signals, kTolerance);
  CHECK(verdict.state == State::kStable);
  CHECK(verdict.energy == 1.5);
  CHECK(verdict.displacement == 0.4);
  CHECK(verdict.volume_error == Approx(1e-6));
}

TEST_CASE("verdict: energy, place, volume or numbers gone make it diverged") {
  // Oracle: the thresholds of the header, from both sides.
  auto signals = calm();
  signals.energy[50] = 0.99 * kDivergedGain;
  CHECK(state_of(signals) == State::kStable);
  signals.energy[50] = 1.01 * kDivergedGain;
  CHECK(state_of(signals) == State::kDiverged);
  signals = calm();
  signals.displacement.back() = 1.01 * kDivergedDisplacement;
  CHECK(is_lost(signals, kTolerance));
  CHECK(state_of(signals) == State::kDiverged);
  signals = calm();
  signals.energy[50] = std::numeric_limits<double>::quiet_NaN();
  CHECK(state_of(signals) == State::kDiverged);
  signals = calm();
  signals.volume_error.back() = std::numeric_limits<double>::infinity();
  CHECK(state_of(signals) == State::kDiverged);
  signals = calm();
  signals.inverted = 0.6;
  CHECK(state_of(signals) == State::kDiverged);
}

TEST_CASE("verdict: velocities that turn round in every step oscillate, unless they have died") {
  // Oracle: v alternates, its cosine from step to step is −1.
  auto signals = calm();
  signals.turning.assign(kSteps, 1);
  CHECK(state_of(signals) == State::kOscillating);
  Tolerance lenient = kTolerance;
  lenient.may_turn = true;
  CHECK(judge(signals, lenient).state == State::kStable);
  signals.kinetic.assign(kSteps, 0.1 * kStill);
  CHECK(state_of(signals) == State::kStable);
  signals = calm();
  for (int i = 0; i < kSteps / 2; ++i) signals.turning[static_cast<std::size_t>(i)] = 1;
  CHECK(state_of(signals) == State::kStable);  // only the last tenth counts
}

TEST_CASE("verdict: energy or volume that goes away drifts, where it is asked for") {
  // Oracle: a tenth of the energy over the run, 1 % of the volume at its end.
  auto signals = calm();
  for (int i = 0; i < kSteps; ++i) signals.energy[static_cast<std::size_t>(i)] = 1 - 0.003 * i;
  CHECK(state_of(signals) == State::kDrifting);
  CHECK(judge(signals, {1, kAnything, 0.01}).state == State::kStable);
  signals = calm();
  for (std::size_t i = 80; i < kSteps; ++i) signals.volume_error[i] = 0.02;
  CHECK(state_of(signals) == State::kDrifting);
  CHECK(judge(signals, {1, 0.1, kAnything}).state == State::kStable);
}

TEST_CASE("verdict: what is only inaccurate stands, what oscillates or diverges does not") {
  // Oracle: the definition of the frontier.
  CHECK(holds(State::kStable));
  CHECK(holds(State::kDrifting));
  CHECK_FALSE(holds(State::kOscillating));
  CHECK_FALSE(holds(State::kDiverged));
  CHECK(std::string(name_of(State::kOscillating)) == "oscillating");
}

}  // namespace
}  // namespace palpate::stability
