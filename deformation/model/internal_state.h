// What the state of a model holds beyond positions and velocities.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "modules/core/state_archive.h"
#include "modules/core/types.h"

namespace palpate::deformation {

/// Goes with the positions and velocities kept here. A step that finds the organ elsewhere, for it
/// was put there from outside, begins with what those positions and velocities say alone.
struct InternalState {
  Eigen::VectorXd pressures;   ///< Taylor–Hood elements: p of the corners [Pa], else empty
  Eigen::VectorXd amplitudes;  ///< modal: a [m·kg^½], else empty
  Eigen::VectorXd rates;       ///< modal: ȧ [m·kg^½/s], else empty
  std::vector<Vec3> positions, velocities;

  void exchange(StateArchive& archive) {
    archive(pressures, amplitudes, rates, positions, velocities);
  }
  bool goes_with(const std::vector<Vec3>& x, const std::vector<Vec3>& v) const {
    return positions == x && velocities == v;
  }
};

}  // namespace palpate::deformation
