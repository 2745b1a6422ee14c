// Equilibrium of a solid under constrained nodes, obstacles and, in motion, inertia: Newton's
// method.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "deformation/contact/element_contact.h"
#include "deformation/contact/enclosed_fluid.h"
#include "deformation/linear_algebra/multifrontal_ldlt.h"

namespace palpate::deformation {

/// Adds M factor (x − predicted): what a time integrator makes of inertia.
struct Inertia {
  double factor = 0;                ///< [1/s²]
  std::span<const Vec3> predicted;  ///< [m]  (node_count)
};

struct NewtonReport {
  bool converged = false;
  int iterations = 0;      ///< of Newton
  int factorisations = 0;  ///< fewer where they are kept
  double deepest = 0;      ///< penetration left [m]
};

/// What an equilibrium is good enough for. Force unit f = μ · size².
struct NewtonGoal {
  double force_tolerance = 1e-9;   ///< of f
  double most_penetration = 2e-5;  ///< of the size
  /// A factorisation is used again while steps with it get nearer by more than half. For large
  /// meshes, where a factorisation costs as much as twenty residuals.
  bool keeps_factor = false;
};

class QuasiStaticNewton {
 public:
  static constexpr int kMostIterations = 40;   ///< in all
  static constexpr double kFluidShare = 1e-2;  ///< a dent is a small part of a cavity

  /// @param solid    outlives this
  /// @param constrained     true: this coordinate of this node does not move  (3 · node_count)
  /// @param contact  outlives this; null: none
  /// @param fluid    likewise
  QuasiStaticNewton(const TaylorHoodElements& solid, std::vector<char> constrained,
                    ElementContact* contact, const EnclosedFluid* fluid = nullptr);

  /// From `state`, constrained coordinates where they are to be. Stops when, in this order,
  ///   1. ‖r_u‖ ≤ force_tolerance f and ‖r_p‖ ≤ force_tolerance size³, of a fluid
  ///      |V − V₀| ≤ kFluidShare of that, and
  ///   2. no point penetrates by more than most_penetration · size, and friction is settled: else
  ///      λ is augmented and 1. starts anew;
  /// not converged after kMostIterations, or where no step along Newton's direction keeps J > 0.
  /// @param keep_going  asked in each iteration and factorisation; may throw, and then the state is
  ///                    somewhere on the way
  NewtonReport solve(
      SolidState& state, std::optional<Inertia> inertia = {}, const NewtonGoal& goal = {},
      const std::function<void()>& keep_going = [] {});

  /// Residual of the whole; empty if J ≤ 0 somewhere. Constrained coordinates have their reactions'
  /// sign turned: r is the force the support has to exert [N]. V₀ − V of a fluid is the last.
  Eigen::VectorXd residual(const SolidState& state, const std::optional<Inertia>& inertia) const;

  /// Factors the tangent. @param positive  as in TaylorHoodElements::tangent()
  /// @returns false if it is singular
  bool factor(
      const SolidState& state, const std::optional<Inertia>& inertia, bool positive = false,
      const std::function<void()>& keep_going = [] {});
  const MultifrontalLdlt& factorisation() const { return factor_; }

 private:
  /// Factors a tangent whose K is positive: the true one where it is.
  bool factor_descending(const SolidState& state, const std::optional<Inertia>& inertia,
                         const std::function<void()>& keep_going);
  double norm(const Eigen::VectorXd& residual) const;
  /// Newton's step from there, by the factorisation; of a fluid, whose row is dense, bordered.
  Eigen::VectorXd step(const Eigen::VectorXd& residual, const SolidState& state) const;
  /// Newton's step, shortened where contact closes on the way or J would fall to 0; moves the
  /// state.
  bool search(const Eigen::VectorXd& direction, const std::optional<Inertia>& inertia,
              SolidState& state, Eigen::VectorXd& residual) const;

  const TaylorHoodElements& solid_;
  std::vector<char> constrained_;
  ElementContact* contact_;
  const EnclosedFluid* fluid_;
  std::vector<ElementMass> masses_;  ///< empty until inertia was asked for
  MultifrontalLdlt factor_;
};

}  // namespace palpate::deformation
