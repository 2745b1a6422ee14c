#include "deformation/elements/linear_tetrahedra.h"

#include <Eigen/LU>

namespace palpate::deformation {

LinearTetrahedra::LinearTetrahedra(const std::vector<Vec3>& rest_positions,
                                   std::vector<geometry::Tetrahedron> tetrahedra)
    : node_count(rest_positions.size()), corners(std::move(tetrahedra)) {
  const auto& x = rest_positions;
  volumes.reserve(size());
  gradients.reserve(size());
  centres.reserve(size());
  for (const auto& t : corners) {
    Mat3 edges;
    for (int k = 0; k < 3; ++k) edges.col(k) = x[t[static_cast<std::size_t>(k) + 1]] - x[t[0]];
    volumes.push_back(edges.determinant() / 6);
    Mat34 g;
    g.rightCols<3>() = edges.inverse().transpose();
    g.col(0) = -g.rightCols<3>().rowwise().sum();
    gradients.push_back(g);
    centres.push_back((x[t[0]] + x[t[1]] + x[t[2]] + x[t[3]]) / 4);
  }
}

Mat3 LinearTetrahedra::deformation_gradient(std::size_t e, std::span<const Vec3> positions) const {
  // Differences first: large coordinates cancel exactly enough.
  const auto& t = corners[e];
  const Vec3& origin = positions[t[0]];
  Mat3 F = (positions[t[1]] - origin) * gradients[e].col(1).transpose();
  F += (positions[t[2]] - origin) * gradients[e].col(2).transpose();
  F += (positions[t[3]] - origin) * gradients[e].col(3).transpose();
  return F;
}

}  // namespace palpate::deformation
