// The tissue's force near the pose for which deformation computed it:
// f(x) = force + K (anchor − x), its normal part never pulling, its tangential part within the
// friction cone. A pure function of model and position.
//
// Friction at tick rate: tangentially the model is a spring about the anchor, cut at μ f_n. It has
// no memory of its own: whether the probe sticks or slides, and where the spring is anchored, is
// decided by deformation, once per step, by the anchor and force of the next model.
#pragma once

#include "modules/core/touch.h"

namespace palpate::haptics {

/// Force and torque on the probe, in W [N, N·m]; torque about the probe's origin.
struct Wrench {
  Vec3 force = Vec3::Zero();
  Vec3 torque = Vec3::Zero();

  bool is_finite() const { return force.allFinite() && torque.allFinite(); }
};

/// Every number finite, normal of length 1 within kUnitTolerance, friction and radius ≥ 0.
bool is_usable(const LocalLaw& law);

struct LawForce {
  Wrench wrench;
  bool beyond_validity = false;  ///< evaluated at the validity radius instead of at the probe
};

/// Force of `law` with the probe's origin at `p_W`. Further than the validity radius from the
/// anchor, the displacement is shortened to that radius. The torque keeps the lever arm of the
/// anchor: it scales with the normal force.
/// @pre is_usable(law), p_W finite. Numbers near the largest double may give an infinite result.
LawForce evaluate(const LocalLaw& law, const Vec3& p_W);

}  // namespace palpate::haptics
