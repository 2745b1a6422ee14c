// The local law of a flat, elastic wall z ≤ 0 touched by a probe's origin.
#pragma once

#include <algorithm>

#include "modules/core/touch.h"

namespace palpate::testing {

/// A row without friction, the probe at `anchor`.
/// @param rate_of_change  of the law [N/m]: the wall's stiffness, or about 0 for a bare force
inline LocalLaw wall_law(const Vec3& anchor, double stiffness, double rate_of_change) {
  LocalLaw law;
  law.anchor.position = anchor;
  law.validity_radius = 0.05;
  law.rows.resize(1);
  law.rows[0].gap = std::max(0.0, anchor.z());
  law.rows[0].force.z() = std::max(0.0, -stiffness * anchor.z());
  law.compliance = {1 / std::max(rate_of_change, 1e-6)};
  law.stiffness(2, 2) = anchor.z() < 0 ? 1 / law.compliance[0] : 0;
  return law;
}
inline LocalLaw wall_law(const Vec3& anchor, double stiffness) {
  return wall_law(anchor, stiffness, stiffness);
}

}  // namespace palpate::testing
