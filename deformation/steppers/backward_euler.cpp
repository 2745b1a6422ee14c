#include "deformation/steppers/backward_euler.h"

#include <Eigen/LU>
#include <cmath>

#include "deformation/contact/contact_tilt.h"
#include "deformation/contact/coupled_inverse_mass.h"
#include "deformation/linear_algebra/conjugate_gradients.h"

namespace palpate::deformation {

BackwardEuler::BackwardEuler(const OrganModel& model, const KeptVolume& volume, int iterations,
                             ChunkRunner* runner)
    : model_(model),
      volume_(volume),
      max_iterations_(iterations),
      ranges_(runner),
      springs_(model, model.network(), volume.is_kept, runner),
      projection_(runner),
      contacts_(model, springs_, runner),
      kernel_(model, model.network(), volume.is_kept, runner) {
  for (const double mass : model.masses) total_mass_ += mass;
  for (auto* buffer : {&change_, &residual_, &trial_}) {
    buffer->assign(model.node_count(), Vec3::Zero());
  }
  for (auto* buffer : {&inner_change_, &inner_residual_, &projected_, &product_}) {
    buffer->assign(model.node_count(), Vec4f::Zero());
  }
  inverse_mass_blocks_.assign(model.node_count(), Mat3::Zero());
}

StepReport BackwardEuler::step(double h, std::span<ContactRow> rows, OrganState& state) {
  StepReport report;
  started_.keep(rows);
  // 1. springs, volume and forces after free flight
  linearise_springs(h, rows, state);
  report.volume_skipped = !linearise_volume(h, state.target_volume, state.velocities);

  // 2.-5. contacts, springs and volume
  solve(h, rows, state);
  if (std::abs(volume_impulse_) > h * state.pressure_limit) {
    push_with(std::copysign(h * state.pressure_limit, volume_impulse_), h, rows, state);
    report.pressure_capped = true;
  }

  // 6. the new state, and what the linearisation of the volume left
  for_nodes(change_.size(), [&](std::size_t i) {
    state.velocities[i] += change_[i];
    state.positions[i] += h * state.velocities[i];
  });
  for (int k = 0; volume_row_ && k < volume_.corrections; ++k) correct_volume(h, rows, state);
  state.pressure = -volume_impulse_ / h;
  return report;
}

void BackwardEuler::solve(double h, std::span<ContactRow> rows, const OrganState& state) {
  // 2. which contacts close
  volume_impulse_ = 0;
  forces_.resize(residual_.size());
  for_nodes(residual_.size(), [&](std::size_t i) { forces_[i] = residual_[i]; });
  friction_.begin(rows);
  solve_impulses(h, rows, state, WarmStart::kToApply, kMostSweeps);

  // 3. springs and friction, with those contacts and the volume held
  linearise_friction(rows);
  update_residual(rows);
  relax_springs(rows, state);

  // 4. what opened or closed meanwhile
  const bool fine = !rows.empty() && contacts_.choose(h, predicted_.positions, rows);
  solve_impulses(h, rows, state, WarmStart::kFrictionKept, fine ? kSweepsBetween : kMostSweeps);

  // 5. springs and friction about the contacts
  for (int pass = 0; fine && pass < kFrictionPasses; ++pass) relax_contacts(h, rows, state);
  keep_momentum(h, rows, state);
}

/// At trial_. The residual has the friction there, the matrix (from relax_…() on) how it changes,
/// and so has W; what c is taken from has not.
void BackwardEuler::linearise_friction(std::span<ContactRow> rows) {
  std::vector<std::uint32_t> changed;
  for (const auto& [node, block] : without_friction_) {
    inverse_mass_blocks_[node] = block;
    changed.push_back(node);
  }
  without_friction_.clear();
  couplings_.resize(tilt_count_);
  springs_.couple(couplings_);
  friction_.linearise(inverse_mass_blocks_, trial_, rows);
  friction_.append_couplings(rows, couplings_);
  const std::span added = std::span(couplings_).subspan(tilt_count_);
  for (const ContactCoupling& coupling : added) {
    for (const std::uint32_t node : coupling.nodes) {
      without_friction_.emplace_back(node, inverse_mass_blocks_[node]);
      changed.push_back(node);
    }
  }
  for (const ContactCoupling& coupling : added) take_coupling(coupling, inverse_mass_blocks_);
  for (const std::uint32_t node : changed) take_volume_answer(node);
}

/// Solves with a given impulse of the contents, which is one more outside force.
void BackwardEuler::push_with(double volume_impulse, double h, std::span<ContactRow> rows,
                              const OrganState& state) {
  started_.give(rows);
  linearise_springs(h, rows, state);
  volume_row_.reset();
  const auto& gradient = free_.volume.gradient;
  for (std::size_t i = 0; i < gradient.size(); ++i) {
    if (model_.inverse_masses[i] > 0) residual_[i] -= volume_impulse * gradient[i];
  }
  solve(h, rows, state);
  volume_impulse_ = volume_impulse;
}

void BackwardEuler::linearise_springs(double h, std::span<const ContactRow> rows,
                                      const OrganState& state) {
  predicted_.velocities.resize(state.velocities.size());
  predicted_.positions.resize(state.positions.size());
  for_nodes(state.positions.size(), [&](std::size_t i) {
    predicted_.velocities[i] = state.velocities[i];
    predicted_.positions[i] = state.positions[i] + h * state.velocities[i];
  });
  kernel_.free_step(h, predicted_, free_);
  springs_.linearise(predicted_.positions, h);
  for_nodes(model_.node_count(), [&](std::size_t i) {
    change_[i].setZero();
    residual_[i].setZero();
    if (model_.inverse_masses[i] == 0) return;
    residual_[i] = model_.masses[i] * (free_.velocities[i] - state.velocities[i]);
    inverse_mass_blocks_[i] = 0.5 * springs_.diagonal()[i].inverse();
  });
  without_friction_.clear();
  couplings_.clear();
  append_tilt_couplings(rows, state.positions, h, couplings_);
  tilt_count_ = couplings_.size();
  take_tilts(state);
}

/// In A, in W, and at this velocity.
void BackwardEuler::take_tilts(const OrganState& state) {
  for (const ContactCoupling& coupling : couplings_) {
    take_coupling(coupling, inverse_mass_blocks_);
    double speed = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      speed += coupling.arms[k].head<3>().cast<double>().dot(state.velocities[coupling.nodes[k]]);
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t node = coupling.nodes[k];
      if (model_.inverse_masses[node] == 0) continue;
      residual_[node] -= speed * coupling.arms[k].head<3>().cast<double>();
    }
  }
}

bool BackwardEuler::linearise_volume(double h, double target_volume,
                                     const std::vector<Vec3>& velocities) {
  VolumeGradient& volume = free_.volume;
  volume_row_.reset();
  if (!volume_.is_kept) return true;
  if (!(volume.denominator > kVanishedDenominator * model_.rest_denominator)) return false;
  const double rate = (volume.volume - target_volume) / h -
                      sum_of(volume.gradient.size(),
                             [&](std::size_t i) { return volume.gradient[i].dot(velocities[i]); });
  volume_row_.emplace(VolumeRow{volume, rate});
  take_volume_answers();
  return true;
}

/// W g, and gᵀWg, of inverse_mass_blocks_ as they are.
void BackwardEuler::take_volume_answers() {
  if (!volume_row_) return;
  VolumeGradient& volume = free_.volume;
  volume_answers_.resize(volume.gradient.size());
  volume.denominator = sum_of(volume.gradient.size(), [&](std::size_t i) {
    volume_answers_[i] = inverse_mass_blocks_[i] * volume.gradient[i];
    return volume.gradient[i].dot(volume_answers_[i]);
  });
}

/// The same where only this node's block has changed.
void BackwardEuler::take_volume_answer(std::size_t node) {
  if (!volume_row_ || node >= volume_answers_.size()) return;
  const Vec3& gradient = free_.volume.gradient[node];
  const Vec3 before = volume_answers_[node];
  volume_answers_[node] = inverse_mass_blocks_[node] * gradient;
  free_.volume.denominator += gradient.dot(volume_answers_[node] - before);
}

void BackwardEuler::solve_impulses(double h, std::span<ContactRow> rows, const OrganState& state,
                                   WarmStart start, int most_sweeps) {
  const std::size_t moved = moved_by_volume();
  const double volume_velocity = sum_of(trial_.size(), [&](std::size_t i) {
    trial_[i] = state.velocities[i] + change_[i] + inverse_mass_blocks_[i] * residual_[i];
    return i < moved ? free_.volume.gradient[i].dot(trial_[i]) : 0;
  });
  hold_rows(h, rows, volume_velocity, start, most_sweeps, state.velocities);
}

double BackwardEuler::volume_velocity() {
  return sum_of(moved_by_volume(),
                [&](std::size_t i) { return free_.volume.gradient[i].dot(trial_[i]); });
}

void BackwardEuler::hold_rows(double h, std::span<ContactRow> rows, double volume_velocity,
                              WarmStart start, int most_sweeps,
                              const std::vector<Vec3>& velocities) {
  const VolumeRow* const volume = volume_row_ ? &*volume_row_ : nullptr;
  const double sigma = solve_contacts(inverse_mass_blocks_, volume, volume_velocity, h, rows,
                                      trial_, start, most_sweeps)
                           .volume_impulse;
  volume_impulse_ += sigma;
  const std::size_t moved = moved_by_volume();
  for_nodes(trial_.size(), [&](std::size_t i) {
    if (i < moved) trial_[i] -= sigma * volume_answers_[i];
    change_[i] = trial_[i] - velocities[i];
  });
}

void BackwardEuler::update_residual(std::span<const ContactRow> rows) {
  auto& nodes = springs_.nodes();
  for_nodes(change_.size(), [&](std::size_t i) { nodes[i].vector = wide(change_[i]); });
  springs_.apply(product_);
  const std::size_t moved = moved_by_volume();
  for_nodes(change_.size(), [&](std::size_t i) {
    residual_[i] = forces_[i] - product_[i].head<3>().cast<double>();
    if (i < moved) residual_[i] -= volume_impulse_ * free_.volume.gradient[i];
  });
  take_impulses_from(rows);
}

void BackwardEuler::update_local_residual(std::span<const ContactRow> rows) {
  auto& nodes = springs_.nodes();
  for_nodes(change_.size(), [&](std::size_t i) { nodes[i].vector = wide(change_[i]); });
  springs_.apply(contacts_.slices(), product_);
  for (const std::uint32_t i : contacts_.nodes()) {
    residual_[i] = forces_[i] - product_[i].head<3>().cast<double>();
    if (volume_row_) residual_[i] -= volume_impulse_ * volume_row_->at.gradient[i];
  }
  take_impulses_from(rows);
}

void BackwardEuler::take_impulses_from(std::span<const ContactRow> rows) {
  for (const ContactRow& row : rows) {
    const Vec3 impulse = row.tangential_impulse - row.normal_impulse * row.normal;
    for (int k = 0; k < 3; ++k) residual_[row.nodes[k]] += row.weights[k] * impulse;
  }
}

void BackwardEuler::relax_springs(std::span<ContactRow> rows, const OrganState& state) {
  springs_.couple(couplings_);
  using Gradient = std::span<const Vec3>;
  projection_.prepare(inverse_mass_blocks_,
                      volume_row_ ? Gradient(volume_row_->at.gradient) : Gradient(), rows);
  for_nodes(residual_.size(), [&](std::size_t i) {
    inner_residual_[i] = wide(residual_[i]);
    inner_change_[i].setZero();
  });
  // Until nothing worth the name is left to gain.
  ProjectedSystem<SpringHessianProduct> system{projection_,     springs_,   inner_change_,
                                               inner_residual_, projected_, product_};
  const double negligible = total_mass_ * kNegligibleVelocity * kNegligibleVelocity;
  iterations_used_ = conjugate_gradients(system, max_iterations_, negligible).iterations;
  projection_.take_impulses(rows, volume_impulse_, inner_residual_);
  for_nodes(residual_.size(), [&](std::size_t i) {
    change_[i] += inner_change_[i].head<3>().cast<double>();
    trial_[i] = state.velocities[i] + change_[i];
    residual_[i] = inner_residual_[i].head<3>().cast<double>();
  });
  friction_.apply(inverse_mass_blocks_, trial_, rows);
  for (const ContactRow& row : rows) {
    for (const std::uint32_t node : row.nodes)
      change_[node] = trial_[node] - state.velocities[node];
  }
}

void BackwardEuler::relax_contacts(double h, std::span<ContactRow> rows, const OrganState& state) {
  linearise_friction(rows);
  update_local_residual(rows);
  springs_.couple(couplings_);
  contacts_.solve(inverse_mass_blocks_, residual_, rows);
  for (std::size_t i = 0; i < contacts_.nodes().size(); ++i) {
    trial_[contacts_.nodes()[i]] += contacts_.change()[i].head<3>().cast<double>();
  }
  friction_.apply(inverse_mass_blocks_, trial_, rows);
  hold_rows(h, rows, volume_velocity(), WarmStart::kFrictionKept, kMostSweeps, state.velocities);
}

/// Truncated iterations leave a little of the total momentum undone. An organ that is not fixed can
/// be given it, so that it gets what its probes feel: a common velocity strains no spring and
/// changes no volume, and goes a few micrometres into a probe at most.
void BackwardEuler::keep_momentum(double h, std::span<const ContactRow> rows,
                                  const OrganState& state) {
  if (!model_.fixed_nodes.empty()) return;
  const double mass_factor = 1 + h * model_.drag;
  Vec3 missing = Vec3::Zero();
  for (const ContactRow& row : rows) {
    missing += row.tangential_impulse - row.normal_impulse * row.normal;
  }
  for (std::size_t i = 0; i < change_.size(); ++i) {
    missing += model_.masses[i] * (h * (model_.gravity - model_.drag * state.velocities[i]) -
                                   mass_factor * change_[i]);
  }
  const Vec3 shift = missing / (mass_factor * total_mass_);
  for_nodes(change_.size(), [&](std::size_t i) { change_[i] += shift; });
}

void BackwardEuler::correct_volume(double h, std::span<ContactRow> rows, OrganState& state) {
  kernel_.evaluate_volume(state.positions, free_);
  if (!linearise_volume(h, state.target_volume, state.velocities)) return;
  trial_ = state.velocities;
  hold_rows(h, rows, volume_velocity(), WarmStart::kFrictionKept, kMostSweeps, state.velocities);
  for_nodes(trial_.size(), [&](std::size_t i) {
    state.positions[i] += h * change_[i];
    state.velocities[i] = trial_[i];
  });
}

}  // namespace palpate::deformation
