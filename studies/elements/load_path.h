// Equilibria under a load that rises, with smaller strides where Newton fails.
#pragma once

#include "deformation/contact/rigid_contact.h"
#include "deformation/steppers/quasi_static_newton.h"
#include "studies/elements/verification.h"

namespace palpate::elements_bench {

class LoadPath {
 public:
  /// Sets the load, a number; may move the state to a better start, and held coordinates.
  using Apply = std::function<void(double load, deformation::SolidState& state)>;

  /// @param contact  null: none. All outlive this.
  LoadPath(const deformation::TaylorHoodElements& solid, deformation::QuasiStaticNewton& solver,
           deformation::RigidContact* contact, const Setting& setting);

  void set_longest_stride(double stride) { longest_stride_ = stride; }

  /// Equal strides up to `load`, halved after a failure.
  /// @returns false if the longest stride fails even when halved six times; the state is the last
  ///          equilibrium.
  /// @throws what Setting::keep_going does
  bool advance_to(double load, const Apply& apply);

  const deformation::SolidState& state() const { return state_; }
  int take_iterations();  ///< Newton iterations since the call before

 private:
  static constexpr int kMostHalvings = 6;  ///< of a stride
  bool attempt(double load, const Apply& apply);

  deformation::QuasiStaticNewton& solver_;
  deformation::RigidContact* contact_;
  const Setting& setting_;
  deformation::SolidState state_;
  double load_ = 0, longest_stride_ = 0.1;
  int iterations_ = 0;
};

}  // namespace palpate::elements_bench
