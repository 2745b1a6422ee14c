// Derivatives of J = det F, the ratio of volume to volume at rest.
#pragma once

#include "deformation/materials/constitutive_law.h"

namespace palpate::deformation {

/// ∂J/∂F = J F⁻ᵀ.
Mat3 cofactor(const Mat3& F);
/// ∂²J/∂F².
Mat9 cofactor_derivative(const Mat3& F);

}  // namespace palpate::deformation
