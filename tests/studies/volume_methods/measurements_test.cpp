#include "studies/volume_methods/measurements.h"

#include <catch2/catch.hpp>
#include <map>

namespace palpate::volume_methods {
namespace {

Method method(const std::string& name) {
  for (const Method& candidate : compared_methods()) {
    if (candidate.name == name) return candidate;
  }
  FAIL(name);
  return {};
}

TEST_CASE("volume methods: volume errors of the squeezed ball fall in the expected order") {
  // Oracle: what each keeps: nothing, a mean radius, the volume up to p/K, up to what the last 1/a
  // has not yet corrected, up to the linearisation of a step, and without that.
  double before = 1;
  for (const char* name : {"mass_spring", "bourguignon_cani", "penalty", "baumgarte",
                           "implicit_volume", "implicit_volume+1"}) {
    INFO(name);
    const auto errors = squeeze_ball(method(name), true);
    CHECK_FALSE(errors.diverged);
    CHECK(errors.peak < before / 2);
    before = errors.peak;
  }
  CHECK(before < 1e-12);
  CHECK(squeeze_ball(method("promayon"), true).peak < 1e-12);
  CHECK(squeeze_ball(method("post_stabilisation"), true).held < 1e-12);
}

TEST_CASE("volume methods: methods that keep the same volume feel the same force") {
  // Oracle: one equilibrium. 1 %: what Promayon's contacts give way by.
  const double force = squeeze_ball(method("implicit_volume"), true).force;
  REQUIRE(force > 0.1);
  for (const char* name : {"baumgarte", "promayon", "post_stabilisation", "implicit_volume+1"}) {
    INFO(name);
    CHECK(squeeze_ball(method(name), true).force == Approx(force).epsilon(0.01));
  }
}

TEST_CASE("volume methods: no method is given a step that is not stable") {
  // Oracle: bisection over runs. The bounds are Gershgorin's, so on the safe side.
  for (const Method& each : compared_methods()) {
    INFO(each.name);
    const auto limits = step_limits(each, true);
    CHECK(limits.given < limits.measured);
    CHECK(limits.given > 0.02 * limits.measured);
  }
}

TEST_CASE("volume methods: springs and smooth energies drift by less than 0.1 % in 4 s") {
  // Oracle: symplectic Euler keeps an energy near the true one; methods that move positions after
  // the step do not, and lose.
  for (const char* name : {"mass_spring", "penalty", "bourguignon_cani", "implicit_volume"}) {
    INFO(name);
    CHECK(std::abs(energy_drift(method(name), true)) < 1e-3);
  }
  CHECK(energy_drift(method("promayon"), true) < -1e-3);
  CHECK(energy_drift(method("element_volume"), true) < -1e-2);
  CHECK(std::isnan(energy_drift(method("chainmail"), true)));
}

}  // namespace
}  // namespace palpate::volume_methods
