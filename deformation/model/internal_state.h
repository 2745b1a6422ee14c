// What the state of a model holds beyond positions and velocities.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "modules/core/state_archive.h"
#include "modules/core/types.h"

namespace palpate::deformation {

/// Where it keeps positions and velocities, it belongs to these: a step that finds the organ
/// elsewhere, because it was put there from outside, begins with what is there alone.
struct InternalState {
  /// Taylor–Hood elements: p of the corners; elements that remember theirs: of each
  /// (steppers/augmented_pressures.h); else empty [Pa]
  Eigen::VectorXd pressures;
  Eigen::VectorXd shape_pressures;  ///< what the shape alone says beside the latter [Pa], or empty
  Eigen::VectorXd amplitudes;       ///< modal: a [m·kg^½], else empty
  Eigen::VectorXd rates;            ///< modal: ȧ [m·kg^½/s], else empty
  std::vector<Vec3> positions, velocities;

  void exchange(StateArchive& archive) {
    archive(pressures, shape_pressures, amplitudes, rates, positions, velocities);
  }
  bool goes_with(const std::vector<Vec3>& x, const std::vector<Vec3>& v) const {
    return positions == x && velocities == v;
  }
};

}  // namespace palpate::deformation
