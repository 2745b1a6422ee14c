// Quadrature rules and quadratic shape functions on the tetrahedron and the triangle, in
// barycentric coordinates.
#pragma once

#include <Eigen/Core>
#include <array>

#include "deformation/elements/quadratic_mesh.h"

namespace palpate::deformation {

struct TetrahedronPoint {
  Eigen::Vector4d barycentric;
  double weight = 0;  ///< of the volume; all weights sum to 1
};

struct TrianglePoint {
  Vec3 barycentric;
  double weight = 0;  ///< of the area
};

/// Exact to degree 2. O. Zienkiewicz, R. Taylor, "The Finite Element Method".
const std::array<TetrahedronPoint, 4>& four_point_rule();
/// Exact to degree 5. N. Walkington, "Quadrature on simplices of arbitrary dimension", 2000.
const std::array<TetrahedronPoint, 14>& fourteen_point_rule();
/// Exact to degree 4. D. Dunavant, Int. J. Numer. Methods Eng. 21, 1985.
const std::array<TrianglePoint, 6>& six_point_rule();

/// N_a at a point of the tetrahedron: corners L (2L−1), edges 4 L_a L_b.
Eigen::Matrix<double, kElementNodes, 1> quadratic_shape(const Eigen::Vector4d& barycentric);
/// ∂N_a/∂(L₁, L₂, L₃) with L₀ = 1 − L₁ − L₂ − L₃.
Eigen::Matrix<double, kElementNodes, 3> quadratic_shape_gradient(
    const Eigen::Vector4d& barycentric);

/// N_a at a point of the six-node triangle.
Eigen::Matrix<double, kFaceNodes, 1> face_shape(const Vec3& barycentric);
/// ∂N_a/∂(L₁, L₂) with L₀ = 1 − L₁ − L₂.
Eigen::Matrix<double, kFaceNodes, 2> face_shape_gradient(const Vec3& barycentric);

}  // namespace palpate::deformation
