#include "deformation/steppers/quasi_static_newton.h"

#include <algorithm>
#include <cmath>

#include "modules/core/error.h"

namespace palpate::deformation {
namespace {

constexpr int kMostTrials = 10;
constexpr double kSlopeFraction = 0.5;
/// Of the residual, by a step with a factorisation that may be of an earlier state.
constexpr double kUsefulDecrease = 0.4;

MultifrontalLdlt make_factor(const TaylorHoodElements& solid,
                             const std::vector<char>& constrained) {
  std::vector<std::vector<int>> dofs;
  std::vector<Vec3> centres;
  for (std::size_t e = 0; e < solid.element_count(); ++e) {
    const auto all = solid.dofs(e);
    dofs.emplace_back(all.begin(), all.end());
    for (int& dof : dofs.back()) {
      if (static_cast<std::size_t>(dof) < constrained.size() &&
          constrained[static_cast<std::size_t>(dof)]) {
        dof = -1;
      }
    }
    Vec3 sum = Vec3::Zero();
    for (int a = 0; a < 4; ++a) sum += solid.mesh().nodes[solid.mesh().elements[e][a]];
    centres.push_back(sum / 4);
  }
  return {solid.dof_count(), std::move(dofs), std::move(centres)};
}

void add_scaled(const Eigen::VectorXd& direction, double scale, SolidState& state) {
  for (std::size_t i = 0; i < state.positions.size(); ++i) {
    state.positions[i] += scale * direction.segment<3>(static_cast<Eigen::Index>(3 * i));
  }
  const auto displacements = static_cast<Eigen::Index>(3 * state.positions.size());
  const Eigen::Index solid = displacements + state.pressures.size();
  state.pressures += scale * direction.segment(displacements, state.pressures.size());
  if (direction.size() > solid) state.fluid_pressure += scale * direction[solid];
}

}  // namespace

QuasiStaticNewton::QuasiStaticNewton(const TaylorHoodElements& solid, std::vector<char> constrained,
                                     ElementContact* contact, const EnclosedFluid* fluid)
    : solid_(solid),
      constrained_(std::move(constrained)),
      contact_(contact),
      fluid_(fluid),
      factor_(make_factor(solid, constrained_)) {
  PALPATE_DEMAND(constrained_.size() == solid.displacement_count());
  for (std::size_t e = 0; e < solid.element_count(); ++e) masses_.push_back(solid.mass(e));
}

Eigen::VectorXd QuasiStaticNewton::residual(const SolidState& state,
                                            const std::optional<Inertia>& inertia) const {
  const auto count = static_cast<Eigen::Index>(solid_.dof_count());
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(count + (fluid_ ? 1 : 0));
  if (fluid_) sum[count] = fluid_->rest_volume() - fluid_->volume(state);
  ElementVector local;
  for (std::size_t e = 0; e < solid_.element_count(); ++e) {
    if (!solid_.residual(e, state, local)) return {};
    if (contact_) contact_->add_residual(e, state, local);
    if (fluid_) fluid_->add_residual(e, state, local);
    if (inertia) {
      Eigen::Matrix<double, 3, kElementNodes> offset;
      for (int a = 0; a < kElementNodes; ++a) {
        const auto node = solid_.mesh().elements[e][a];
        offset.col(a) = state.positions[node] - inertia->predicted[node];
      }
      const Eigen::Matrix<double, 3, kElementNodes> forces = inertia->factor * offset * masses_[e];
      local.head<30>() += forces.reshaped();
    }
    sum(solid_.dofs(e)) += local;
  }
  return sum;
}

bool QuasiStaticNewton::factor(const SolidState& state, const std::optional<Inertia>& inertia,
                               bool positive, const std::function<void()>& keep_going) {
  ElementMatrix matrix;
  const auto matrix_of = [&](std::size_t e) -> Eigen::Ref<const Eigen::MatrixXd> {
    solid_.tangent(e, state, matrix, positive);
    if (contact_) contact_->add_tangent(e, state, matrix, positive);
    if (fluid_ && !positive) fluid_->add_tangent(e, state, matrix);
    if (!inertia) return matrix;
    for (int b = 0; b < kElementNodes; ++b) {
      for (int a = 0; a < kElementNodes; ++a) {
        for (int i = 0; i < 3; ++i) {
          matrix(3 * a + i, 3 * b + i) += inertia->factor * masses_[e](a, b);
        }
      }
    }
    return matrix;
  };
  return factor_.factor(matrix_of, keep_going);
}

// [K B; Bᵀ −C] has one negative pivot per pressure while K is positive (on what C leaves).
bool QuasiStaticNewton::factor_descending(const SolidState& state,
                                          const std::optional<Inertia>& inertia,
                                          const std::function<void()>& keep_going) {
  if (factor(state, inertia, false, keep_going) &&
      factor_.negative_pivots() == solid_.mesh().corner_count) {
    return true;
  }
  return factor(state, inertia, true, keep_going);
}

double QuasiStaticNewton::norm(const Eigen::VectorXd& residual) const {
  double forces = 0;
  for (std::size_t i = 0; i < constrained_.size(); ++i) {
    const double r = constrained_[i] ? 0 : residual[static_cast<Eigen::Index>(i)];
    forces += r * r;
  }
  const double size = solid_.size();
  const double fluid = fluid_ ? std::abs(residual[residual.size() - 1]) / kFluidShare : 0;
  const double volumes = residual
                             .segment(static_cast<Eigen::Index>(constrained_.size()),
                                      static_cast<Eigen::Index>(solid_.mesh().corner_count))
                             .norm();
  return std::max(std::sqrt(forces) / (solid_.tissue().shear_modulus() * size * size),
                  std::max(volumes, fluid) / (size * size * size));
}

// [K g; gᵀ 0] [d; Δp] = −[r; V₀ − V], g = −∂V/∂x.
Eigen::VectorXd QuasiStaticNewton::step(const Eigen::VectorXd& residual,
                                        const SolidState& state) const {
  if (!fluid_) {
    Eigen::VectorXd direction = -residual;
    factor_.solve(direction);
    return direction;
  }
  const Eigen::Index count = residual.size() - 1;
  const Eigen::VectorXd g = fluid_->gradient(state);
  Eigen::MatrixXd solved(count, 2);
  solved << -residual.head(count), g;
  factor_.solve(solved);
  const double pressure = (g.dot(solved.col(0)) + residual[count]) / g.dot(solved.col(1));
  Eigen::VectorXd direction(count + 1);
  direction << solved.col(0) - pressure * solved.col(1), pressure;
  return direction;
}

// s(α) = d·r_u(x + α d) is the slope of the energy along the step; a contact that closes on the way
// makes it rise steeply. Crisfield's search: α by regula falsi until |s| ≤ kSlopeFraction |s(0)|.
bool QuasiStaticNewton::search(const Eigen::VectorXd& direction,
                               const std::optional<Inertia>& inertia, SolidState& state,
                               Eigen::VectorXd& residual) const {
  const auto displacements = static_cast<Eigen::Index>(constrained_.size());
  const auto slope = [&](const Eigen::VectorXd& r) {
    return direction.head(displacements).dot(r.head(displacements));
  };
  const double start = slope(residual);
  double low = 0, low_slope = start, high = 0, high_slope = 0, step = 1;
  for (int trial = 0; trial < kMostTrials; ++trial) {
    SolidState moved = state;
    add_scaled(direction, step, moved);
    Eigen::VectorXd r = this->residual(moved, inertia);
    if (r.size() == 0 || !r.allFinite()) {
      if (trial + 1 == kMostTrials) return false;
      step = low + (step - low) / 2;
      high = 0;
      continue;
    }
    const double s = slope(r);
    const bool done = start >= 0 || std::abs(s) <= kSlopeFraction * std::abs(start) ||
                      (s < 0 && high == 0) || trial + 1 == kMostTrials;
    if (done) {
      state = std::move(moved);
      residual = std::move(r);
      return true;
    }
    (s < 0 ? low : high) = step;
    (s < 0 ? low_slope : high_slope) = s;
    const double secant = low - low_slope * (high - low) / (high_slope - low_slope);
    step = std::clamp(secant, low + 0.1 * (high - low), high - 0.1 * (high - low));
  }
  return false;
}

NewtonReport QuasiStaticNewton::solve(SolidState& state, std::optional<Inertia> inertia,
                                      const NewtonGoal& goal,
                                      const std::function<void()>& keep_going) {
  NewtonReport report;
  bool is_useful = false;  // the factorisation there is, of a state before
  Eigen::VectorXd r = residual(state, inertia);
  while (r.size() > 0 && r.allFinite()) {
    while (norm(r) > goal.force_tolerance) {
      keep_going();
      if (++report.iterations > kMostIterations) return report;
      if (!is_useful) {
        ++report.factorisations;
        if (!factor_descending(state, inertia, keep_going)) return report;
      }
      const double before = norm(r);
      const Eigen::VectorXd direction = step(r, state);
      if (!search(direction, inertia, state, r)) return report;
      is_useful = goal.keeps_factor && norm(r) < kUsefulDecrease * before;
    }
    report.deepest = contact_ ? contact_->deepest(state) : 0;
    report.converged = report.deepest <= goal.most_penetration * solid_.size() &&
                       (!contact_ || contact_->is_settled(state));
    if (report.converged) return report;
    contact_->augment(state);
    r = residual(state, inertia);
  }
  return report;
}

}  // namespace palpate::deformation
