#include "deformation/steppers/xpbd_springs.h"

namespace palpate::deformation {

void inertial_prediction(const Body& body, double h, const OrganState& state,
                         std::vector<Vec3>& velocities) {
  velocities.resize(state.velocities.size());
  const double kept = 1 - h * body.drag;
  for (std::size_t i = 0; i < velocities.size(); ++i) {
    const bool moves = body.inverse_masses[i] > 0;
    velocities[i] = moves ? Vec3(kept * state.velocities[i] + h * body.gravity) : Vec3::Zero();
  }
}

StepReport XpbdSprings::step(double h, std::span<ContactRow> rows, OrganState& state) {
  // 1. inertial prediction; 2. springs
  inertial_prediction(model_, h, state, free_.velocities);
  visits_.relax(h, iterations_, state.positions, free_.velocities, positions_);

  // 3. volume, as it would be there, and contacts
  kernel_.evaluate_volume(positions_, free_);
  // Φ(x) + h g·Δv = 0, written for v̂ + Δv as the solver wants it.
  const VolumeRow volume{free_.volume,
                         (free_.volume.volume - state.target_volume) / h - free_.volume_velocity};
  const auto report = solve_contacts(model_, volume_.is_kept ? &volume : nullptr,
                                     free_.volume_velocity, h, rows, free_.velocities);

  // 4. the new state
  kernel_.finish_step(h, report.volume_impulse, free_, state);
  state.pressure = -report.volume_impulse / h;
  return {report.volume_skipped};
}

double XpbdSprings::elastic_energy(const OrganState& state) {
  return kernel_.elastic_energy(state.positions);
}

}  // namespace palpate::deformation
