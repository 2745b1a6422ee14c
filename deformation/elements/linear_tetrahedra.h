// Tetrahedra with linear shape functions N_a: what of them is constant.
#pragma once

#include <span>
#include <vector>

#include "modules/geometry/tet_mesh.h"

namespace palpate::deformation {

using Mat34 = Eigen::Matrix<double, 3, 4>;

struct LinearTetrahedra {
  std::size_t node_count = 0;
  std::vector<geometry::Tetrahedron> corners;
  std::vector<double> volumes;   ///< V at rest [m³]
  std::vector<Mat34> gradients;  ///< g_a = ∇N_a at rest, by columns [1/m]
  std::vector<Vec3> centres;     ///< at rest [m]

  /// @param rest_positions  [m]
  LinearTetrahedra(const std::vector<Vec3>& rest_positions,
                   std::vector<geometry::Tetrahedron> tetrahedra);

  std::size_t size() const { return corners.size(); }

  /// F = Σ_a x_a g_aᵀ
  Mat3 deformation_gradient(std::size_t e, std::span<const Vec3> positions) const;
};

}  // namespace palpate::deformation
