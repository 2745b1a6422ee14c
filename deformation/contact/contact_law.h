// What the rows of a local law (LocalLaw, core/touch.h) resist a probe with.
#pragma once

#include "modules/core/touch.h"

namespace palpate::deformation {

/// −∂f/∂x of a law's rows that press [N/m].
struct RowStiffness {
  Mat3 matrix = Mat3::Zero();  ///< symmetric part
  bool bounded = false;  ///< sliding would be stiffer than sticking: taken as sticking; or zero
};

/// Rows on their cone slide, with friction the same part of what presses them, as long as that is
/// no stiffer than sticking: no force along a normal grows faster than that of rows that stick.
/// Zero where rows press and W is not regular.
RowStiffness stiffness_of(const LocalLaw& law);

}  // namespace palpate::deformation
