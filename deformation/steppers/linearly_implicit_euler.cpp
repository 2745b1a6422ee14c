#include "deformation/steppers/linearly_implicit_euler.h"

#include <Eigen/LU>
#include <algorithm>

namespace palpate::deformation {
namespace {

/// Rounds of conjugate gradients, at most; the contacts are revised between them.
constexpr int kMaxRounds = 6;
/// How often contacts that are still penetrated are held by more, all rounds again, at most.
constexpr int kMostGoingOn = 4;

}  // namespace

LinearlyImplicitEuler::LinearlyImplicitEuler(const Body& body,
                                             std::unique_ptr<ElasticForceElements> elements,
                                             int iterations)
    : body_(body), elements_(std::move(elements)), max_iterations_(iterations) {
  for (const double mass : body.masses) total_mass_ += mass;
  shift_.assign(body.node_count(), 0);
  predicted_.assign(body.node_count(), Vec3::Zero());
  velocities_.assign(body.node_count(), Vec3::Zero());
  for (auto* buffer : {&change_, &load_, &residual_, &preconditioned_, &direction_, &product_}) {
    buffer->assign(body.node_count(), Vec4f::Zero());
  }
  inverse_diagonal_.assign(body.node_count(), Mat3::Zero());
  diagonal_ = inverse_diagonal_;
  preconditioner_.assign(body.node_count(), {Vec4f::Zero(), Vec4f::Zero(), Vec4f::Zero()});
}

StepReport LinearlyImplicitEuler::step(double h, std::span<ContactRow> rows, OrganState& state) {
  linearise(h, state);
  if (rows.empty()) begin_with_free_motion();
  solve(h, rows, state);
  keep_momentum(h, rows, state);
  for (std::size_t i = 0; i < velocities_.size(); ++i) {
    state.velocities[i] = velocities_[i];
    state.positions[i] += h * velocities_[i];
  }
  state.pressure = mean_pressure();
  return {};
}

void LinearlyImplicitEuler::add_stiffness(const Patch& patch, double share,
                                          Eigen::MatrixXf& sum) const {
  if (!(step_ > 0)) return;
  const double scale = share / (step_ * step_);
  elements_->add_block(patch, static_cast<float>(scale), sum);
  for (const std::uint32_t node : patch.nodes) {
    sum.diagonal().segment<3>(3 * patch.place(node)).array() -=
        static_cast<float>(scale * shift_[node]);
  }
}

void LinearlyImplicitEuler::linearise(double h, const OrganState& state) {
  step_ = h;
  for (std::size_t i = 0; i < predicted_.size(); ++i) {
    predicted_[i] = state.positions[i] + h * state.velocities[i];
    shift_[i] = (1 + h * body_.drag) * body_.masses[i];
  }
  elements_->linearise(predicted_, h * h, shift_);
  for (std::size_t i = 0; i < predicted_.size(); ++i) {
    change_[i].setZero();
    load_[i].setZero();
    if (body_.inverse_masses[i] == 0) continue;
    const Vec3 outer = body_.masses[i] * (body_.gravity - body_.drag * state.velocities[i]);
    load_[i] = wide(h * (elements_->forces()[i] + outer));
    inverse_diagonal_[i] = elements_->diagonal()[i].inverse();
    set_preconditioner(i, inverse_diagonal_[i]);
  }
}

/// Of an organ that nothing holds or touches, as one: what 3×3 blocks are slowest to find.
void LinearlyImplicitEuler::begin_with_free_motion() {
  if (!body_.fixed_nodes.empty()) return;
  Vec3 load = Vec3::Zero();
  double mass = 0;
  for (std::size_t i = 0; i < load_.size(); ++i) {
    load += load_[i].head<3>().cast<double>();
    mass += shift_[i];
  }
  std::fill(change_.begin(), change_.end(), wide(load / mass));
}

void LinearlyImplicitEuler::solve(double h, std::span<ContactRow> rows, const OrganState& state) {
  velocities_ = state.velocities;
  contacts_.begin(inverse_diagonal_, rows, h, velocities_);
  find_contacts(rows, state);
  const auto is_deep = [&](const ContactRow& row) {
    return excess_depth(body_, row, h, velocities_) > kUnsolvedDepth;
  };
  for (int more = 0; more < kMostGoingOn && std::ranges::any_of(rows, is_deep); ++more) {
    contacts_.go_on(rows, velocities_);
    find_contacts(rows, state);
  }
}

void LinearlyImplicitEuler::find_contacts(std::span<ContactRow> rows, const OrganState& state) {
  iterations_used_ = 0;
  const double negligible = total_mass_ * kNegligibleVelocity * kNegligibleVelocity;
  // Short rounds until the contacts are found, then the rest of the iterations.
  const int share = (max_iterations_ + kMaxRounds - 1) / kMaxRounds;
  bool found = rows.empty();
  for (int round = 0; round < kMaxRounds && iterations_used_ < max_iterations_; ++round) {
    take_preconditioner(rows);
    take_residual(rows);
    const int left = max_iterations_ - iterations_used_;
    System system{*this, rows};
    const auto report =
        conjugate_gradients(system, found ? left : std::min(share, left), negligible);
    iterations_used_ += report.iterations;
    for (std::size_t i = 0; i < change_.size(); ++i) {
      velocities_[i] = state.velocities[i] + change_[i].head<3>().cast<double>();
    }
    found = !contacts_.update(rows, velocities_);
    if (found && report.converged) break;
  }
}

/// Contacts change it at their nodes alone.
void LinearlyImplicitEuler::take_preconditioner(std::span<const ContactRow> rows) {
  for (const ContactRow& row : rows) {
    for (const std::uint32_t node : row.nodes) diagonal_[node] = elements_->diagonal()[node];
  }
  contacts_.add_to_diagonal(rows, diagonal_);
  for (const ContactRow& row : rows) {
    for (const std::uint32_t node : row.nodes) {
      if (body_.inverse_masses[node] > 0) set_preconditioner(node, diagonal_[node].inverse());
    }
  }
}

void LinearlyImplicitEuler::set_preconditioner(std::size_t node, const Mat3& inverse) {
  for (int k = 0; k < 3; ++k) {
    preconditioner_[node][static_cast<std::size_t>(k)] = wide(inverse.col(k));
  }
}

void LinearlyImplicitEuler::take_residual(std::span<const ContactRow> rows) {
  elements_->apply(change_, product_);
  residual_ = load_;
  add(-1, product_, residual_);
  contacts_.add_impulses(rows, residual_);
}

double LinearlyImplicitEuler::System::begin() {
  std::ranges::fill(step.direction_, Vec4f::Zero());
  const double descent = descend(0);
  step.direction_ = step.preconditioned_;
  return descent;
}

double LinearlyImplicitEuler::System::curvature() {
  step.elements_->apply(step.direction_, step.product_);
  step.contacts_.apply(rows, step.direction_, step.product_);
  return dot(step.direction_, step.product_);
}

/// All in one pass over the nodes; r·z is summed as dot() does.
double LinearlyImplicitEuler::System::descend(double length) {
  const auto along = static_cast<float>(length);
  double descent = 0;
  const std::size_t count = step.change_.size();
  for (std::size_t first = 0; first < count; first += kDotBlock) {
    Vec4f block = Vec4f::Zero();
    for (std::size_t i = first; i < std::min(first + kDotBlock, count); ++i) {
      step.change_[i] += along * step.direction_[i];
      const Vec4f r = step.residual_[i] - along * step.product_[i];
      const auto& P = step.preconditioner_[i];
      const Vec4f z = r[0] * P[0] + r[1] * P[1] + r[2] * P[2];
      step.residual_[i] = r;
      step.preconditioned_[i] = z;
      block += r.cwiseProduct(z);
    }
    descent += block.sum();
  }
  return descent;
}

void LinearlyImplicitEuler::System::turn(double kept) {
  const auto part = static_cast<float>(kept);
  for (std::size_t i = 0; i < step.direction_.size(); ++i) {
    step.direction_[i] = step.preconditioned_[i] + part * step.direction_[i];
  }
}

/// Truncated iterations leave a little of the total momentum undone. An organ that nothing holds
/// can be given it: a common velocity strains nothing.
void LinearlyImplicitEuler::keep_momentum(double h, std::span<const ContactRow> rows,
                                          const OrganState& state) {
  if (!body_.fixed_nodes.empty()) return;
  for (const ContactRow& row : rows) {
    if (row.normal_impulse > 0) return;
  }
  const double mass_factor = 1 + h * body_.drag;
  Vec3 missing = Vec3::Zero();
  for (std::size_t i = 0; i < velocities_.size(); ++i) {
    missing +=
        body_.masses[i] * (h * body_.gravity + state.velocities[i] - mass_factor * velocities_[i]);
  }
  const Vec3 shift = missing / (mass_factor * total_mass_);
  for (Vec3& velocity : velocities_) velocity += shift;
}

/// Of the tissue, by the virial Σ f·x = −∫ tr σ dV [Pa].
double LinearlyImplicitEuler::mean_pressure() const {
  double virial = 0;
  for (std::size_t i = 0; i < predicted_.size(); ++i)
    virial += elements_->forces()[i].dot(predicted_[i]);
  return virial / (3 * body_.rest_volume);
}

}  // namespace palpate::deformation
