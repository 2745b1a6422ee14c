// The inside of a surface organ as pyramids: one over each triangle, with one apex for all, the
// virtual node nearest to the surface's centre.
//
// Having one apex they add up to the enclosed volume (with an apex per section of the axis, wedges
// between the apexes would belong to nobody: a squeezed ball then loses 9 % that no pyramid knows
// of). Where the surface bends behind itself, as a stomach's does, some pyramids are negative.
#pragma once

#include <array>
#include <vector>

#include "deformation/model/organ_model.h"

namespace palpate::deformation {

struct Pyramid {
  std::array<std::uint32_t, 4> nodes{};  ///< the triangle's corners, then the apex
  double rest_volume = 0;  ///< positive where the triangle faces away from the apex [m³]
  double area_share = 0;   ///< of the triangle in the surface's rest area
};

struct PyramidVolume {
  double volume = 0;               ///< signed [m³]
  std::array<Vec3, 4> gradient{};  ///< by the four nodes, sums to zero [m²]
};

/// One per triangle, in their order. The model must have virtual nodes.
std::vector<Pyramid> build_pyramids(const OrganModel& model);

PyramidVolume evaluate_pyramid(const Pyramid& pyramid, const std::vector<Vec3>& positions);

}  // namespace palpate::deformation
