#include "palpate/device/swing.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace palpate;
using launcher::Swing;

TEST_CASE("swing: a vibration that dies is at rest from when its box is small enough") {
  // Oracle: analytic, x = a exp(−t/τ) cos ωt. Within the last kSpan before r it still leaves the
  // box whose side is the amplitude to either side at r; a second of it swings by its envelope.
  constexpr double kAmplitude = 0.01, kTau = 0.2, kOmega = 200, kRest = 1e-4;
  const auto envelope = [](double t) { return kAmplitude * std::exp(-t / kTau); };
  Swing swing;
  for (int i = 0; i < 3000; ++i) {
    const double t = 1e-3 * i;
    swing.add(t, Vec3(0, envelope(t) * std::cos(kOmega * t), 1));
  }
  const auto since = swing.rests_since(kRest);
  REQUIRE(since);
  const double period = 2 * M_PI / kOmega;
  CHECK(2 * envelope(*since + period) <= kRest);
  CHECK(2 * envelope(*since - Swing::kSpan) >= kRest);
  // 2 to 3 s, sampled every 0.2 rad: what is next to an extreme is at least cos 0.1 of it, and two
  // extremes lie within the first period.
  CHECK(swing.last_second() <= 2 * envelope(2.0));
  CHECK(swing.last_second() >= 0.995 * 2 * envelope(2.0 + period));
}

TEST_CASE("swing: what keeps moving does not rest, what never moved has rested from the start") {
  // Oracle: definition; a point that creeps by 1 mm/s is 0.1 mm further every kSpan.
  Swing creeping, still;
  for (int i = 0; i < 2000; ++i) {
    creeping.add(1e-3 * i, Vec3(1e-6 * i, 0, 0));
    still.add(1e-3 * i, Vec3(3, 2, 1));
  }
  CHECK_FALSE(creeping.rests_since(0.9e-4).has_value());
  CHECK(creeping.last_second() == Approx(999e-6));
  CHECK(still.rests_since(0) == 0.0);
  CHECK(still.last_second() == 0);
}
