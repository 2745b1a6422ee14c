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
  visits_.relax(h, iterations_, state.positions, positions_);

  // 3. volume, as it would be there, and contacts
  const double per_h = 1 / h;
  velocities_.resize(positions_.size());
  for (std::size_t i = 0; i < positions_.size(); ++i) {
    velocities_[i] = per_h * (positions_[i] - state.positions[i]);
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

double XpbdSprings::elastic_energy(const OrganState& state) {
  return deformation::elastic_energy(model_, state.positions);
}

}  // namespace palpate::deformation
