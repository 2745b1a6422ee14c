#include "deformation/solids/xpbd_springs.h"

#include <optional>

#include "deformation/contact_solve.h"
#include "deformation/spring_forces.h"

namespace palpate::deformation {

void free_flight(const OrganModel& model, double h, const OrganState& state,
                 std::vector<Vec3>& positions) {
  positions = state.positions;
  const double reach = h / (1 + h * model.drag);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (model.inverse_masses[i] == 0) continue;
    positions[i] += reach * (state.velocities[i] + h * model.gravity);
  }
}

StepReport XpbdSprings::step(double h, std::span<ContactRow> rows, OrganState& state) {
  // 1. where all would fly alone; 2. springs
  free_flight(model_, h, state, positions_);
  multipliers_.assign(model_.network.springs.size(), 0);
  for (int k = 0; k < iterations_; ++k) relax_springs(h, state.positions);

  // 3. volume, as it would be there, and contacts
  velocities_.resize(positions_.size());
  for (std::size_t i = 0; i < positions_.size(); ++i) {
    velocities_[i] = (positions_[i] - state.positions[i]) / h;
  }
  std::optional<VolumeRow> row;
  if (model_.preserve_volume) {
    evaluate_volume(model_, positions_, volume_);
    double rate = (volume_.volume - state.target_volume) / h;
    for (std::size_t i = 0; i < volume_.gradient.size(); ++i) {
      rate -= volume_.gradient[i].dot(velocities_[i]);
    }
    row.emplace(VolumeRow{volume_, rate});
  }
  const auto report = solve_contacts_and_volume(model_, row ? &*row : nullptr, h, rows, velocities_,
                                                StartImpulses::kToApply);

  // 4. the new state
  for (std::size_t i = 0; i < positions_.size(); ++i) {
    state.velocities[i] = velocities_[i];
    state.positions[i] += h * velocities_[i];
  }
  state.pressure = -report.volume_impulse / h;
  return {report.volume_skipped};
}

void XpbdSprings::relax_springs(double h, const std::vector<Vec3>& start) {
  for (std::size_t s = 0; s < model_.network.springs.size(); ++s) {
    const Spring& spring = model_.network.springs[s];
    const auto a = spring.node_a, b = spring.node_b;
    const double inverse_mass = model_.inverse_masses[a] + model_.inverse_masses[b];
    const Vec3 arm = positions_[b] - positions_[a];
    const double length = arm.norm();
    if (inverse_mass == 0 || length == 0 || spring.stiffness == 0) continue;
    const Vec3 u = arm / length;
    const double compliance = 1 / (spring.stiffness * h * h);
    const double damping = model_.spring_damping[s] / (spring.stiffness * h);
    const double closing = u.dot(arm - (start[b] - start[a]));
    const double lambda =
        -(length - spring.rest_length + damping * closing + compliance * multipliers_[s]) /
        ((1 + damping) * inverse_mass + compliance);
    multipliers_[s] += lambda;
    positions_[a] -= model_.inverse_masses[a] * lambda * u;
    positions_[b] += model_.inverse_masses[b] * lambda * u;
  }
}

double XpbdSprings::elastic_energy(const OrganState& state) {
  return deformation::elastic_energy(model_, state.positions);
}

}  // namespace palpate::deformation
