#include "deformation/steppers/implicit_solid.h"

#include <Eigen/LU>
#include <algorithm>

namespace palpate::deformation {
namespace {

/// Iterations end when what they could still change is below this [m/s], as a mean weighted by D.
constexpr double kVelocityTolerance = 1e-7;
/// Rounds of conjugate gradients, at most; the contacts are revised between them.
constexpr int kMaxRounds = 6;

}  // namespace

ImplicitSolid::ImplicitSolid(const OrganModel& model, std::unique_ptr<ImplicitTissue> tissue,
                             int iterations)
    : model_(model), tissue_(std::move(tissue)), max_iterations_(iterations) {
  for (const double mass : model.masses) total_mass_ += mass;
  flight_.assign(model.node_count(), Vec3::Zero());
  velocities_.assign(model.node_count(), Vec3::Zero());
  for (auto* buffer : {&change_, &load_, &residual_, &projected_, &direction_, &product_}) {
    buffer->assign(model.node_count(), Vec4f::Zero());
  }
  mobilities_.assign(model.node_count(), Mat3::Zero());
  diagonal_ = mobilities_;
  preconditioner_.assign(model.node_count(), {Vec4f::Zero(), Vec4f::Zero(), Vec4f::Zero()});
}

StepReport ImplicitSolid::step(double h, std::span<ContactRow> rows, OrganState& state) {
  linearise(h, state);
  solve(h, rows, state);
  keep_momentum(h, rows, state);
  for (std::size_t i = 0; i < velocities_.size(); ++i) {
    state.velocities[i] = velocities_[i];
    state.positions[i] += h * velocities_[i];
  }
  state.pressure = mean_pressure();
  return {};
}

void ImplicitSolid::linearise(double h, const OrganState& state) {
  for (std::size_t i = 0; i < flight_.size(); ++i) {
    flight_[i] = state.positions[i] + h * state.velocities[i];
  }
  tissue_->linearise(flight_, h);
  for (std::size_t i = 0; i < flight_.size(); ++i) {
    change_[i].setZero();
    load_[i].setZero();
    if (model_.inverse_masses[i] == 0) continue;
    const Vec3 outer = model_.masses[i] * (model_.gravity - model_.drag * state.velocities[i]);
    load_[i] = wide(h * (tissue_->forces()[i] + outer));
    mobilities_[i] = tissue_->diagonal()[i].inverse();
  }
}

void ImplicitSolid::solve(double h, std::span<ContactRow> rows, const OrganState& state) {
  velocities_ = state.velocities;
  contacts_.begin(mobilities_, rows, h, velocities_);
  iterations_used_ = 0;
  // Short rounds until the contacts are found, then the rest of the iterations.
  const int share = (max_iterations_ + kMaxRounds - 1) / kMaxRounds;
  bool found = rows.empty();
  for (int round = 0; round < kMaxRounds && iterations_used_ < max_iterations_; ++round) {
    take_preconditioner(rows);
    take_residual(rows);
    const int left = max_iterations_ - iterations_used_;
    const bool converged = conjugate_gradients(found ? left : std::min(share, left), rows);
    for (std::size_t i = 0; i < change_.size(); ++i) {
      velocities_[i] = state.velocities[i] + change_[i].head<3>().cast<double>();
    }
    found = !contacts_.update(rows, velocities_);
    if (found && converged) break;
  }
}

void ImplicitSolid::take_preconditioner(std::span<const ContactRow> rows) {
  diagonal_ = tissue_->diagonal();
  contacts_.add_to_diagonal(rows, diagonal_);
  for (std::size_t i = 0; i < diagonal_.size(); ++i) {
    if (model_.inverse_masses[i] == 0) continue;
    const Mat3 inverse = diagonal_[i].inverse();
    for (int k = 0; k < 3; ++k) {
      preconditioner_[i][static_cast<std::size_t>(k)] = wide(inverse.col(k));
    }
  }
}

void ImplicitSolid::take_residual(std::span<const ContactRow> rows) {
  tissue_->apply(change_, product_);
  residual_ = load_;
  add(-1, product_, residual_);
  contacts_.add_impulses(rows, residual_);
}

void ImplicitSolid::precondition() {
  for (std::size_t i = 0; i < residual_.size(); ++i) {
    const auto& P = preconditioner_[i];
    projected_[i] = residual_[i][0] * P[0] + residual_[i][1] * P[1] + residual_[i][2] * P[2];
  }
}

/// Stops when nothing worth the name is left to gain, or all iterations are used up.
/// @returns whether the former
bool ImplicitSolid::conjugate_gradients(int iterations, std::span<const ContactRow> rows) {
  const double negligible = total_mass_ * kVelocityTolerance * kVelocityTolerance;
  precondition();
  direction_ = projected_;
  double descent = dot(residual_, projected_);
  for (int k = 0; k < iterations && descent > negligible; ++k) {
    ++iterations_used_;
    tissue_->apply(direction_, product_);
    contacts_.apply(rows, direction_, product_);
    const double curvature = dot(direction_, product_);
    if (!(curvature > 0)) break;
    const double step = descent / curvature;
    add(step, direction_, change_);
    add(-step, product_, residual_);
    precondition();
    const double last = descent;
    descent = dot(residual_, projected_);
    const auto kept = static_cast<float>(descent / last);
    for (std::size_t i = 0; i < direction_.size(); ++i) {
      direction_[i] = projected_[i] + kept * direction_[i];
    }
  }
  return descent <= negligible;
}

/// Truncated iterations leave a little of the total momentum undone. An organ that nothing holds
/// can be given it: a common velocity strains nothing.
void ImplicitSolid::keep_momentum(double h, std::span<const ContactRow> rows,
                                  const OrganState& state) {
  if (!model_.fixed_nodes.empty()) return;
  for (const ContactRow& row : rows) {
    if (row.normal_impulse > 0) return;
  }
  const double mass_factor = 1 + h * model_.drag;
  Vec3 missing = Vec3::Zero();
  for (std::size_t i = 0; i < velocities_.size(); ++i) {
    missing += model_.masses[i] *
               (h * model_.gravity + state.velocities[i] - mass_factor * velocities_[i]);
  }
  const Vec3 shift = missing / (mass_factor * total_mass_);
  for (Vec3& velocity : velocities_) velocity += shift;
}

/// Of the tissue, by the virial Σ f·x = −∫ tr σ dV [Pa].
double ImplicitSolid::mean_pressure() const {
  double virial = 0;
  for (std::size_t i = 0; i < flight_.size(); ++i) virial += tissue_->forces()[i].dot(flight_[i]);
  return virial / (3 * model_.rest_volume);
}

}  // namespace palpate::deformation
