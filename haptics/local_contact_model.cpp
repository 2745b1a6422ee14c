#include "haptics/local_contact_model.h"

#include <cmath>

#include "haptics/vector_checks.h"

namespace palpate::haptics {

bool is_usable(const ContactModel& model) {
  constexpr double kUnitTolerance = 1e-3;
  return model.anchor.allFinite() && model.force.allFinite() && model.torque.allFinite() &&
         model.stiffness.allFinite() && model.normal.allFinite() &&
         std::abs(model.normal.stableNorm() - 1) <= kUnitTolerance &&
         std::isfinite(model.friction_coefficient) && model.friction_coefficient >= 0 &&
         std::isfinite(model.validity_radius) && model.validity_radius >= 0;
}

ModelForce evaluate(const ContactModel& model, const Vec3& p_W) {
  ModelForce result;
  if (!model.touching) return result;
  const Vec3 displacement = p_W - model.anchor;
  result.beyond_validity = is_longer_than(displacement, model.validity_radius);
  const Vec3 force =
      model.force - model.stiffness * clamp_length(displacement, model.validity_radius);

  const Vec3 normal = model.normal.normalized();
  const double normal_force = normal.dot(force);
  if (normal_force <= 0) return result;
  const Vec3 tangential = force - normal_force * normal;
  const double cone = model.friction_coefficient * normal_force;
  const bool slides = force.allFinite() && is_longer_than(tangential, cone);
  result.wrench.force =
      slides ? Vec3(normal_force * normal + clamp_length(tangential, cone)) : force;
  const double normal_force_at_anchor = normal.dot(model.force);
  if (normal_force_at_anchor > 0) {
    result.wrench.torque = (normal_force / normal_force_at_anchor) * model.torque;
  }
  return result;
}

}  // namespace palpate::haptics
