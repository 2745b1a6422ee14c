// Solids at rest under a sphere or under their weight, by quadratic elements.
#pragma once

#include <functional>
#include <vector>

#include "deformation/elements/taylor_hood.h"

namespace palpate::chart {

/// A frictionless sphere that has moved `depth` along `direction` since it touched at `place`.
struct Press {
  Vec3 place = Vec3::Zero();        ///< on the surface at rest [m]
  Vec3 direction = -Vec3::UnitZ();  ///< unit, into the tissue
  double radius = 0;                ///< of the sphere [m]
  std::vector<double> depths;       ///< rising [m]
  std::vector<Vec3> marks;          ///< near the surface at rest [m]
};

struct Pressed {
  double force = 0;                 ///< on the sphere against its direction [N]
  std::vector<Vec3> displacements;  ///< of the surface's points nearest to the marks [m]
};

/// One per depth; fewer if Newton's method fails at one.
/// @param constrained  as QuasiStaticNewton
/// @param keep_going  asked between loads; may throw
std::vector<Pressed> press_at_rest(const deformation::TaylorHoodElements& solid,
                                   std::vector<char> constrained, const Press& press,
                                   const std::function<void()>& keep_going);

/// Displacements of the surface's points nearest to the marks, under `gravity` [m/s²].
/// @throws std::runtime_error if Newton's method fails
std::vector<Vec3> sag_at_rest(const deformation::TaylorHoodElements& solid,
                              std::vector<char> constrained, const Vec3& gravity,
                              const std::vector<Vec3>& marks,
                              const std::function<void()>& keep_going);

}  // namespace palpate::chart
