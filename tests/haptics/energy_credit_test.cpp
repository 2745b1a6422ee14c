#include "haptics/energy_credit.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

using palpate::haptics::EnergyCredit;

namespace {

constexpr double kT = 1e-3;
constexpr double kStiffness = 400;
constexpr double kFast = 0.1;  ///< [m/s], no rest

}  // namespace

TEST_CASE("energy credit: a moving device feels what its spring was loaded for") {
  // Oracle: analytic, f²/(2K) = E: 0.2 mJ load 400 N/m to 0.4 N. A force that is less is left
  // alone, bit for bit; of a debt nothing is given.
  EnergyCredit credit(kT);
  CHECK(credit.limit(2, kStiffness, 2e-4, kFast) == Approx(0.4).epsilon(1e-12));
  CHECK(credit.limit(0.3, kStiffness, 2e-4, kFast) == 0.3);
  CHECK(credit.limit(2, kStiffness, -1e-3, kFast) == 0);
  CHECK(credit.limit(0, kStiffness, 0, kFast) == 0);
}

TEST_CASE(
    "energy credit: a resting device comes to the whole force in the stated time, and keeps it") {
  // Oracle: analytic. 1 N at 400 N/m is 1.25 mJ; a tick grants 1.25 mJ T/0.2 s, so after n ticks
  // f = √(n T/0.2 s) N. What was granted stays while the force does, moving or not.
  EnergyCredit credit(kT);
  const int whole = static_cast<int>(std::lround(EnergyCredit::kGrantTime / kT));
  for (int i = 1; i <= 2 * whole; ++i) {
    const double share = std::min(1.0, static_cast<double>(i) / whole);
    CHECK(credit.limit(1, kStiffness, 0, 0) == Approx(std::sqrt(share)));
  }
  for (int i = 0; i < 100; ++i) CHECK(credit.limit(1, kStiffness, 0, kFast) == Approx(1));
  credit.limit(0.5, kStiffness, 0, kFast);  // a force that goes takes its grant along
  CHECK(credit.limit(1, kStiffness, 0, kFast) == Approx(0.5));
  credit.clear();
  CHECK(credit.limit(1, kStiffness, 0, kFast) == 0);
}

TEST_CASE("energy credit: a device that swings at more than the stated speed is granted nothing") {
  // Oracle: the stated mean. A sine of 20 mm/s has a root mean square of 14 mm/s, at 25 Hz with a
  // ripple of less than 10 % in its mean over 50 ms.
  EnergyCredit credit(kT);
  double largest = 0;
  for (int i = 0; i < 2000; ++i) {
    const double speed = 0.02 * std::abs(std::sin(2 * M_PI * 25 * kT * i + M_PI / 2));
    largest = std::max(largest, credit.limit(1, kStiffness, 0, speed));
  }
  CHECK(largest == 0);
}

TEST_CASE("energy credit: a speed that is none leaves a bounded force, and is forgotten") {
  // Oracle: invariant. Half a second after the last such speed it is at rest: e^-10 of 1 m²/s² is
  // below 1e-4.
  EnergyCredit credit(kT);
  for (const double speed : {std::numeric_limits<double>::infinity(), 1e308}) {
    const double given = credit.limit(1, kStiffness, 0, speed);
    CHECK(given >= 0);
    CHECK(given <= 1);
  }
  double given = 0;
  for (int i = 0; i < 800; ++i) given = credit.limit(1, kStiffness, 0, 0);
  CHECK(given == Approx(1));
}
