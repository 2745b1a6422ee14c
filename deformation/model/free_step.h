// A step before volume and contacts: what springs, damping, drag and gravity alone do.
#pragma once

#include <vector>

#include "deformation/model/volume_gradient.h"

namespace palpate::deformation {

struct FreeStep {
  VolumeGradient volume;       ///< V, g and gᵀM⁻¹g at the step's start; zeros where not wanted
  double volume_velocity = 0;  ///< g·v̂ [m³/s]
  std::vector<Vec3> velocities;  ///< v̂ = v + h (M⁻¹F + gravity − drag v), 0 where fixed [m/s]
};

}  // namespace palpate::deformation
