#include "deformation/steppers/augmented_pressures.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "tests/deformation/steppers/tetrahedral_solids.h"

namespace palpate::deformation {
namespace {

/// By how much a wave of volume grows over 10,000 steps: ρ (x⁺ − 2x + x₋)/h² = −k p⁺,
/// p⁺ = (1 − s) p + s κ k x⁺, in units of ρ = k = κ = 1.
double growth_of_a_wave(double h, double s) {
  constexpr int kSteps = 10000;
  double before = 1, x = 1, p = 1, first = 0, last = 0;
  for (int n = 0; n < 3 * kSteps; ++n) {
    const double next = (2 * x - before - h * h * (1 - s) * p) / (1 + h * h * s);
    p = (1 - s) * p + s * next;
    before = x;
    x = next;
    double& most = n / kSteps == 1 ? first : last;
    if (n >= kSteps) most = std::max(most, std::abs(x));
  }
  return last / first;
}

TEST_CASE("augmented pressures: the share is the least that feeds no wave of volume") {
  // Oracle: the recurrence itself, run: at 1/(K + 2) a wave does not grow, at 0.9 of that it does.
  for (const double K : {0.01, 0.3, 1.0, 4.0, 20.0}) {
    const double h = std::sqrt(K), s = 1 / (K + 2);
    CHECK(growth_of_a_wave(h, s) < 1 + 1e-6);
    CHECK(growth_of_a_wave(h, 1.1 * s) < 0.1);
    CHECK(growth_of_a_wave(h, 0.9 * s) > 10);
  }
  // Oracle: by hand. A ball of 0.1 m, 1000 kg/m³ and κ' = 1e5 Pa: K = h² · 1e5/1000 · (π/0.1)²/4.
  OrganModel ball = testing::cube_model(testing::solid_organ("nodal_pressure", 0.5));
  ball.rest_volume = 4 * M_PI / 3 * 1e-3;
  ball.masses = {1000 * ball.rest_volume};
  const AugmentedPressures pressures(ball);
  for (const double h : {1e-3, 4e-3}) {
    const double K = h * h * 100 * M_PI * M_PI * 25;
    CHECK(pressures.share(h, {1, 1e5, 1e3}) == Approx(1 / (K + 2)));
  }
  CHECK(pressures.share(1, {1, 1e5, 1e3}) == Approx(0.1));  // 10 μ
  CHECK(pressures.share(1, {1, 1e3, 1e3}) == 1);
  CHECK(pressures.share(1e-9, {1, 1e5, 1e3}) == Approx(0.5));
}

/// Velocities that swell a body, by a thousandth in a tenth of a second, and bend it.
void stir(const OrganModel& model, OrganState& state) {
  for (std::size_t i = 0; i < state.velocities.size(); ++i) {
    const Vec3 x = model.rest_positions[i] - Vec3::Constant(0.03);
    state.velocities[i] = 1e-2 * (x + Vec3(x.y() * x.y(), 0, x.x() * x.z()) / 0.03);
  }
}

TEST_CASE("augmented pressures: a body that is stirred or shaken swings less and less") {
  // Oracle: energy, without drag, of steps that resolve waves of volume and of such that do not.
  // What gives way by more at once keeps up to 1/4s of a motion's energy for a while (K/(1 + sK)²
  // of a wave's); bending goes on. Shaken bodies have tetrahedra inside out.
  const std::string kind = GENERATE("nodal_pressure", "quadratic_pressure");
  const double rate = GENERATE(50.0, 100.0, 250.0, 1000.0);
  const double youngs_modulus = GENERATE(500.0, 5e3, 5e4);
  const bool is_shaken = GENERATE(false, true);
  auto organ = testing::solid_organ(kind, 0.5);
  organ.tissue.youngs_modulus = youngs_modulus;
  const auto model = testing::cube_model(organ, Vec3::Zero(), 3);
  const auto dynamics = make_dynamics(organ, model, 1 / rate);
  auto state = rest_state(model);
  if (is_shaken) {
    state.positions = testing::shaken(model, scene::is_quadratic(kind) ? 4e-3 : 10e-3);
  } else {
    stir(model, state);
  }
  const auto energy = [&] {
    return dynamics->elastic_energy(state) + kinetic_energy(model, state.velocities);
  };
  const double begun = energy();
  double most = 0, last = 0;
  for (int k = 0; k < static_cast<int>(2 * rate); ++k) {
    dynamics->step(1 / rate, {}, state);
    last = energy();
    most = std::max(most, last);
  }
  CAPTURE(kind, rate, youngs_modulus, is_shaken, begun, most, last);
  CHECK(most < (is_shaken ? 1 : 2.5) * begun);
  CHECK(last < 0.2 * begun);
}

}  // namespace
}  // namespace palpate::deformation
