// The rotation of a polar decomposition F = R S.
#pragma once

#include "modules/core/types.h"

namespace palpate {

/// The rotation nearest to F: maximises tr(RᵀF) over det R = 1, whatever the sign of det F. As a
/// quaternion it is the eigenvector to the largest eigenvalue of a 4×4 matrix (B. Horn, J. Opt.
/// Soc. Am. A 4, 1987); the eigenvalue by Newton from above (D. Theobald, Acta Cryst. A61, 2005).
/// The identity if no rotation is nearer than all others (F = 0, mirrored about a point).
Mat3 nearest_rotation(const Mat3& F);

}  // namespace palpate
