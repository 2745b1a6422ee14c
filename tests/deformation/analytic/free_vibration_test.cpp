// Free vibration: what the integrators make of an undamped swing.
#include <catch2/catch.hpp>
#include <cmath>

#include "deformation/steppers/backward_euler.h"
#include "deformation/steppers/symplectic_euler.h"
#include "tests/deformation/organs.h"

namespace palpate::deformation {
namespace {

scene::Organ undamped_organ() {
  auto organ = testing::ball_organ();
  organ.tissue.drag = organ.tissue.damping_ratio = 0;
  return organ;
}

constexpr double kAmplitude = 1e-5;  // [m]

/// Four equal masses on six equal springs. It breathes at ω² = 4 k/m: with all nodes a distance δ
/// outward, each spring is √(8/3) δ longer, so ½·6·k·(8/3) δ² of energy against ½·4·m·δ̇².
struct Tetrahedron {
  OrganModel model;
  double frequency = 0;  ///< ω [rad/s]

  Tetrahedron() {
    auto organ = undamped_organ();
    organ.model = "mass_spring";
    organ.springs.inner_ratio = organ.springs.bending_ratio = 0;
    model = build_organ_model(organ, Vec3::Zero(), geometry::make_tetrahedron(0.05));
    frequency = std::sqrt(4 * model.network().springs[0].stiffness / model.masses[0]);
  }

  /// √(a² + (ȧ/ω)²) of its breath after `steps`, over what it was.
  double remaining_amplitude(OrganDynamics& dynamics, double h, int steps) const {
    auto state = rest_state(model);
    const double speed = kAmplitude * frequency;
    const Vec3 outward = state.positions[0].normalized();
    for (std::size_t i = 0; i < 4; ++i)
      state.velocities[i] = speed * state.positions[i].normalized();
    for (int s = 0; s < steps; ++s) dynamics.step(h, {}, state);
    const double displacement = outward.dot(state.positions[0] - model.rest_positions[0]);
    return std::hypot(displacement, outward.dot(state.velocities[0]) / frequency) / kAmplitude;
  }
};

TEST_CASE("free vibration: backward Euler takes 1/√(1 + h²ω²) of the amplitude per step") {
  // Oracle: the scheme's eigenvalues 1/(1 ∓ ihω). A swing of 1e-5 m on springs of 8 cm is linear
  // to 1e-4 or so; floats know the nodes to 5e-9 m.
  const Tetrahedron tetrahedron;
  BackwardEuler dynamics(tetrahedron.model, {.is_kept = false});
  for (const double h_omega : {0.1, 0.5, 2.0, 10.0}) {
    const int steps = h_omega < 1 ? 20 : 3;
    const double expected = std::pow(1 + h_omega * h_omega, -0.5 * steps);
    CHECK(tetrahedron.remaining_amplitude(dynamics, h_omega / tetrahedron.frequency, steps) ==
          Approx(expected).epsilon(1e-3).margin(5e-9 / kAmplitude));
  }
}

TEST_CASE("free vibration: symplectic Euler keeps the amplitude") {
  // Oracle: the scheme's eigenvalues lie on the unit circle; the orbit is an ellipse with axes in
  // ratio 1 ± hω/2.
  const Tetrahedron tetrahedron;
  auto dynamics = testing::springs_alone(tetrahedron.model);
  for (const double h_omega : {0.05, 0.1}) {
    const int steps = 10'000;
    CHECK(tetrahedron.remaining_amplitude(dynamics, h_omega / tetrahedron.frequency, steps) ==
          Approx(1).epsilon(0.6 * h_omega));
  }
}

/// The ball's swing between a rugby ball and a lentil, volume kept: q = Σ m (z² − (x² + y²)/2)
/// against its rest value, sampled every step.
std::vector<double> swing(OrganDynamics& dynamics, const OrganModel& model, double h,
                          double duration) {
  auto state = rest_state(model);
  for (std::size_t i = 0; i < model.node_count(); ++i) {
    const Vec3& p = model.rest_positions[i];
    state.velocities[i] = 0.1 * Vec3(-0.5 * p.x(), -0.5 * p.y(), p.z());
  }
  const auto moment = [&](const std::vector<Vec3>& positions) {
    double sum = 0;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      const Vec3& p = positions[i];
      sum += model.masses[i] * (p.z() * p.z() - 0.5 * (p.x() * p.x() + p.y() * p.y()));
    }
    return sum;
  };
  const double at_rest = moment(state.positions);
  std::vector<double> samples;
  for (double t = h; t < duration; t += h) {
    dynamics.step(h, {}, state);
    samples.push_back(moment(state.positions) - at_rest);
  }
  return samples;
}

/// Largest |sample| of each half swing.
std::vector<double> peaks(const std::vector<double>& samples) {
  std::vector<double> found{0};
  for (std::size_t s = 0; s < samples.size(); ++s) {
    if (s > 0 && (samples[s] > 0) != (samples[s - 1] > 0)) found.push_back(0);
    found.back() = std::max(found.back(), std::abs(samples[s]));
  }
  found.pop_back();  // may be cut off
  return found;
}

/// Logarithm of the amplitude lost per half swing.
double decay(const std::vector<double>& peaks) {
  return std::log(peaks.front() / peaks.back()) / static_cast<double>(peaks.size() - 1);
}

TEST_CASE("free vibration: the swing of a ball decays by backward Euler's formula") {
  // Oracle: the same formula, with ω from the time symplectic Euler takes per half swing, and what
  // the swing loses to other modes from its decay. 15 % of the formula, or 0.02: peaks lie between
  // samples, the push is not quite one mode, and iterations end early.
  const auto model = testing::ball_model(3, undamped_organ());
  auto symplectic = testing::constrained(model);
  const auto undamped = peaks(swing(symplectic, model, 0.5e-3, 1));
  const double omega = M_PI * static_cast<double>(undamped.size());
  const double lost = decay(undamped);
  CHECK(lost < 0.02);

  BackwardEuler dynamics(model);
  for (const double h : {2e-3, 5e-3, 10e-3}) {
    const auto damped = peaks(swing(dynamics, model, h, 1));
    REQUIRE(damped.size() > 3);
    const double expected = 0.5 * std::log1p(h * h * omega * omega) * M_PI / (h * omega);
    INFO("h = " << h << " s, omega = " << omega << " rad/s, lost " << lost);
    CHECK(decay(damped) - lost == Approx(expected).epsilon(0.15).margin(0.02));
  }
}

}  // namespace
}  // namespace palpate::deformation
