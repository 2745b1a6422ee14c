// What a compliance over a period is asked of: rows on an organ, and how the period is stepped.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "modules/core/types.h"

namespace palpate::deformation {

/// How the steps of a period share in it.
struct PeriodSteps {
  double period = 0;  ///< T [s]
  int count = 1;      ///< n
  bool implicit = false;

  /// Of an even motion: the means, over the steps, of the velocities and of the displacements at
  /// which forces are taken, as parts of those at the end: d and k of patch_compliance.h.
  double moving() const { return implicit ? 1 : (count - 1.0) / count; }
  double displaced() const { return (implicit ? count + 1.0 : count - 1.0) / (2.0 * count); }
};

/// Rows on the same nodes depend on each other, so rounding decides whether their W is regular.
/// With this part of its diagonal added it is, and what they share is counted once.
inline constexpr double kRegular = 1e-6;

/// A weighted place on the body and a direction there: a row of C.
struct ComplianceRow {
  std::vector<std::pair<std::uint32_t, double>> weights;  ///< of nodes
  Vec3 axis = Vec3::UnitZ();
  double force = 0;  ///< that presses along it now [N]
};

}  // namespace palpate::deformation
