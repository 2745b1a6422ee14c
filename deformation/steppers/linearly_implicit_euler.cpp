#include "deformation/steppers/linearly_implicit_euler.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace palpate::deformation {
namespace {

/// How often contacts that are still penetrated are held by more, all iterations again, at most.
constexpr int kMostGoingOn = 4;
/// What contacts press with together has settled when it changes by less than this part of it in
/// the last third of the iterations. Slow presses have settled, blows have not.
constexpr double kSettled = 0.07;
constexpr int kThird = 3;
/// So many times as many iterations a step makes beside, at most, for it to settle.
constexpr int kMostSpare = 2;

double pressed_by(std::span<const ContactRow> rows) {
  double sum = 0;
  for (const ContactRow& row : rows) sum += row.normal_impulse;
  return sum;
}

}  // namespace

LinearlyImplicitEuler::LinearlyImplicitEuler(const Body& body,
                                             std::unique_ptr<ElasticForceElements> elements,
                                             int iterations)
    : body_(body), elements_(std::move(elements)), max_iterations_(iterations), pressures_(body) {
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
  pressures_.begin(h, state, *elements_);
  linearise(h, state);
  if (rows.empty()) begin_with_free_motion();
  solve(h, rows, state);
  keep_momentum(h, rows, state);
  for (std::size_t i = 0; i < velocities_.size(); ++i) {
    state.velocities[i] = velocities_[i];
    state.positions[i] += h * velocities_[i];
  }
  pressures_.end(state, *elements_);
  state.pressure = mean_pressure();
  return {};
}

void LinearlyImplicitEuler::foresee(const OrganState& state) {
  if (!(step_ > 0)) return;
  pressures_.begin_evenly(step_, state, *elements_);
  linearise(step_, state);
}

void LinearlyImplicitEuler::add_stiffness(const Patch& patch, Eigen::MatrixXf& sum) const {
  if (!(step_ > 0)) return;
  const double scale = 1 / (step_ * step_);
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
  iterations_used_ = 0;
  for (std::size_t i = 0; i < change_.size(); ++i) {
    velocities_[i] = state.velocities[i] + change_[i].head<3>().cast<double>();
  }
  contacts_.begin(inverse_diagonal_, rows, h, velocities_);
  int spare = kMostSpare * max_iterations_;
  descend(spare, rows, state);
  const auto is_deep = [&](const ContactRow& row) {
    return excess_depth(body_, row, h, velocities_) > kUnsolvedDepth;
  };
  for (int more = 0; more < kMostGoingOn && std::ranges::any_of(rows, is_deep); ++more) {
    contacts_.go_on(rows);
    descend(spare, rows, state);
  }
}

/// Conjugate gradients of an energy that is quadratic in pieces: as far along each direction as it
/// falls, and the next direction by Polak and Ribière.
void LinearlyImplicitEuler::descend(int& spare, std::span<ContactRow> rows,
                                    const OrganState& state) {
  const double negligible = total_mass_ * kNegligibleVelocity * kNegligibleVelocity;
  take_preconditioner(rows);
  take_residual(rows);
  std::ranges::fill(direction_, Vec4f::Zero());
  std::ranges::fill(product_, Vec4f::Zero());
  double descent = go(0).descent, kept = 0;
  bool falls = true;
  const auto iterate = [&](int count) {
    for (; count > 0 && descent > negligible; --count) {
      ++iterations_used_;
      const double along = turn(kept);
      elements_->apply(direction_, product_);
      const double curvature = dot(direction_, product_);
      falls = curvature > 0;
      if (!falls) return;
      contacts_.set_direction(rows, direction_);
      const double length = contacts_.step_length(rows, along, curvature);
      if (contacts_.advance(rows, length, product_)) take_preconditioner(rows);
      const Gone gone = go(length);
      kept = std::max(0.0, -length * gone.change / descent);
      descent = gone.descent;
    }
  };
  const int third = (max_iterations_ + kThird - 1) / kThird;
  iterate(max_iterations_ - third);
  for (bool goes_on = true; goes_on && falls;) {
    const double before = pressed_by(rows);
    iterate(third);
    const double now = pressed_by(rows);
    goes_on = spare >= third && std::abs(now - before) > kSettled * now;
    if (goes_on) spare -= third;
  }
  for (std::size_t i = 0; i < change_.size(); ++i) {
    velocities_[i] = state.velocities[i] + change_[i].head<3>().cast<double>();
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
  residual_ = load_;
  if (std::ranges::any_of(change_, [](const Vec4f& change) { return !change.isZero(0); })) {
    elements_->apply(change_, product_);
    add(-1, product_, residual_);
  }
  contacts_.add_impulses(rows, residual_);
}

Gone LinearlyImplicitEuler::go(double length) {
  return go_along(length, direction_, product_, preconditioner_, change_, residual_,
                  preconditioned_);
}

double LinearlyImplicitEuler::turn(double kept) {
  const auto part = static_cast<float>(kept);
  for (std::size_t i = 0; i < direction_.size(); ++i) {
    direction_[i] = preconditioned_[i] + part * direction_[i];
  }
  const double along = dot(direction_, residual_);
  if (along > 0) return along;
  direction_ = preconditioned_;
  return dot(direction_, residual_);
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
