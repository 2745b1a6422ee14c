#include "deformation/steppers/implicit_motion.h"

#include "modules/core/error.h"

namespace palpate::elements {

ImplicitMotion::ImplicitMotion(EquilibriumSolver& solver, SolidState start,
                               std::vector<Vec3> velocities)
    : solver_(solver), state_(std::move(start)), velocities_(std::move(velocities)) {
  PALPATE_DEMAND(velocities_.size() == state_.positions.size());
}

EquilibriumReport ImplicitMotion::step(double h) {
  const std::vector<Vec3> x = state_.positions, v = velocities_;
  const double reach = first_ ? h : 2 * h / 3;  // x⁺ = base + reach v⁺
  std::vector<Vec3> base(x.size()), predicted(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    base[i] = first_ ? x[i] : Vec3((4 * x[i] - earlier_positions_[i]) / 3);
    predicted[i] =
        base[i] + reach * (first_ ? v[i] : Vec3((4 * v[i] - earlier_velocities_[i]) / 3));
  }
  const auto report = solver_.solve(state_, Inertia{1 / (reach * reach), predicted});
  for (std::size_t i = 0; i < x.size(); ++i) {
    velocities_[i] = (state_.positions[i] - base[i]) / reach;
  }
  earlier_positions_ = x;
  earlier_velocities_ = v;
  first_ = false;
  return report;
}

}  // namespace palpate::elements
