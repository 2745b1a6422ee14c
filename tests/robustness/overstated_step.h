// Dynamics that promise more than they can keep, for guards to be tried on.
#pragma once

#include <random>

#include "deformation/steppers/symplectic_euler.h"
#include "tests/robustness/organs_under_test.h"

namespace palpate::deformation::testing {

/// Symplectic Euler that calls a multiple of its stable step its largest.
class OverstatedStep : public OrganDynamics {
 public:
  OverstatedStep(const OrganModel& model, double factor)
      : inner_(constrained(model)), factor_(factor) {}
  double largest_step() const override { return factor_ * inner_.largest_step(); }
  StepReport step(double h, std::span<ContactRow> rows, OrganState& state) override {
    return inner_.step(h, rows, state);
  }
  double elastic_energy(const OrganState& state) override { return inner_.elastic_energy(state); }

 private:
  SymplecticEuler inner_;
  double factor_;
};

/// A ball of 642 nodes, a little out of shape, with the tissue's stiffness such that `factor` times
/// its largest step is half of kPeriod.
inline SimulatedOrgan ball_with_overstated_step(double factor) {
  auto organ = ball_organ();
  const double h = ImplicitVolume(ball_model(3, organ)).largest_step();
  organ.tissue.youngs_modulus *= std::pow(factor * h / (kPeriod / 2), 2);
  auto model = std::make_unique<const OrganModel>(ball_model(3, organ));
  auto dynamics = std::make_unique<OverstatedStep>(*model, (1 + 1e-9) * factor);
  SimulatedOrgan simulated(organ, std::move(model), std::move(dynamics));
  OrganState state = simulated.state();
  std::mt19937 random(1);
  std::uniform_real_distribution<double> any(-1e-3, 1e-3);
  for (Vec3& p : state.positions) p += Vec3(any(random), any(random), any(random));
  simulated.put(state);
  return simulated;
}

}  // namespace palpate::deformation::testing
