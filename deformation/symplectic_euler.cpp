#include "deformation/symplectic_euler.h"

#include "deformation/spring_forces.h"

namespace palpate::deformation {
namespace {

/// v̂ = v + h M⁻¹F, fixed nodes at rest.
void apply_forces(const OrganModel& model, double h, OrganState& state, std::vector<Vec3>& forces) {
  forces.assign(model.node_count(), Vec3::Zero());
  add_spring_forces(model, state, forces);
  for (std::size_t i = 0; i < model.node_count(); ++i) {
    const Vec3 acceleration = model.inverse_masses[i] * forces[i] + model.gravity;
    const Vec3 velocity =
        state.velocities[i] + h * (acceleration - model.drag * state.velocities[i]);
    state.velocities[i] = model.inverse_masses[i] > 0 ? velocity : Vec3::Zero();
  }
}

}  // namespace

ContactSolveReport symplectic_euler_step(const OrganModel& model, double h,
                                         std::span<ContactRow> rows, OrganState& state,
                                         StepBuffers& buffers) {
  // 1. springs, damping, drag, gravity → unconstrained velocities
  apply_forces(model, h, state, buffers.forces);

  // 2. volume and its gradient at the old positions: Φ = V − V*
  evaluate_volume(model, state.positions, buffers.volume);
  const VolumeRow volume{buffers.volume, (buffers.volume.volume - state.target_volume) / h};

  // 3. contact impulses and the one volume multiplier → velocities at the end of the step
  const auto report = solve_contacts_and_volume(model, model.preserve_volume ? &volume : nullptr, h,
                                                rows, state.velocities);
  state.pressure = -report.volume_impulse / h;

  // 4. positions
  for (std::size_t i = 0; i < model.node_count(); ++i) {
    state.positions[i] += h * state.velocities[i];
  }
  return report;
}

}  // namespace palpate::deformation
