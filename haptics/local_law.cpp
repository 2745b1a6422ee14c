#include "haptics/local_law.h"

#include <cmath>

#include "haptics/vector_checks.h"
#include "modules/core/tolerances.h"

namespace palpate::haptics {

bool is_usable(const LocalLaw& law) {
  return law.anchor.allFinite() && law.force.allFinite() && law.torque.allFinite() &&
         law.stiffness.allFinite() && is_unit(law.normal) &&
         std::isfinite(law.friction_coefficient) && law.friction_coefficient >= 0 &&
         std::isfinite(law.validity_radius) && law.validity_radius >= 0;
}

LawForce evaluate(const LocalLaw& law, const Vec3& p_W) {
  LawForce result;
  if (!law.touching) return result;
  const Vec3 displacement = p_W - law.anchor;
  result.beyond_validity = is_longer_than(displacement, law.validity_radius);
  const Vec3 force = law.force - law.stiffness * clamp_length(displacement, law.validity_radius);

  const Vec3 normal = law.normal.normalized();
  const double normal_force = normal.dot(force);
  if (normal_force <= 0) return result;
  const Vec3 tangential = force - normal_force * normal;
  const double cone = law.friction_coefficient * normal_force;
  const bool slides = force.allFinite() && is_longer_than(tangential, cone);
  result.wrench.force =
      slides ? Vec3(normal_force * normal + clamp_length(tangential, cone)) : force;
  const double normal_force_at_anchor = normal.dot(law.force);
  if (normal_force_at_anchor > 0) {
    result.wrench.torque = (normal_force / normal_force_at_anchor) * law.torque;
  }
  return result;
}

}  // namespace palpate::haptics
