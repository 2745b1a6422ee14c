// What an implicit step of elements solved with.
#pragma once

#include <span>

#include "deformation/elements/elastic_force_elements.h"

namespace palpate::deformation {

/// A = diag(shift) + h² K of the last step. Good until the next one.
struct StepMatrix {
  ElasticForceElements* elements = nullptr;  ///< linearised so; none: no step was made so
  std::span<const double> shift;             ///< [kg]  (node_count)
  std::span<const Vec3> positions;           ///< where K was taken [m]  (node_count)
  double step = 0;                           ///< h [s]

  explicit operator bool() const { return elements != nullptr; }
};

}  // namespace palpate::deformation
