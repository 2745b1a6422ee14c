// From ten nodes to derivatives at four points, and back. At corner k, by its barycentric
// coordinates, a quadratic function u has the derivatives
//   ∂u/∂L_a = 4 u_ka − u_a (u_ka: of the edge's middle),   ∂u/∂L_k = 3 u_k
// and between the corners they are linear. Of the four coordinates, whose sum is 1, L₀ is left out:
//   D_j = ∂u/∂L_j − ∂u/∂L₀,   j = 1, 2, 3
#pragma once

#include "deformation/elements/quadratic_kernel/quadratic_arrays.h"
#include "deformation/elements/quadratic_kernel/quadratic_vectors.h"

namespace palpate::deformation::kernel {
namespace {

/// kTetrahedronEdges, and the middle node of two corners.
constexpr int kEdgeEnds[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};
constexpr int kMiddle[4][4] = {{-1, 4, 6, 7}, {4, -1, 5, 8}, {6, 5, -1, 9}, {7, 8, 9, -1}};

/// D_1, D_2, D_3 at one point.
template <class Set>
struct Derivatives {
  Vectors<Set> along[3];
};

template <class Set>
Vectors<Set> corner_derivative(const Vectors<Set> (&u)[10], int corner, int coordinate) {
  if (corner == coordinate) return 3 * u[corner];
  return 4 * u[kMiddle[corner][coordinate]] - u[coordinate];
}

template <class Set>
void differentiate(const Vectors<Set> (&u)[10], Derivatives<Set> (&at)[4]) {
  Vectors<Set> sums[3] = {};
  for (int k = 0; k < 4; ++k) {
    const Vectors<Set> first = corner_derivative(u, k, 0);
    for (int j = 0; j < 3; ++j) {
      const Vectors<Set> own = corner_derivative(u, k, j + 1) - first;
      sums[j] = sums[j] + own;
      at[k].along[j] = (kNearCorner - kFarCorner) * own;
    }
  }
  for (int j = 0; j < 3; ++j) {
    const Vectors<Set> common = kFarCorner * sums[j];
    for (auto& point : at) point.along[j] = point.along[j] + common;
  }
}

/// The transpose.
template <class Set>
void integrate(const Derivatives<Set> (&at)[4], Vectors<Set> (&u)[10]) {
  Vectors<Set> common[3], corners[4][4], sums[4] = {};
  for (int j = 0; j < 3; ++j) {
    common[j] =
        kFarCorner * ((at[0].along[j] + at[1].along[j]) + (at[2].along[j] + at[3].along[j]));
  }
  for (int k = 0; k < 4; ++k) {
    for (int j = 0; j < 3; ++j) {
      corners[k][j + 1] = common[j] + (kNearCorner - kFarCorner) * at[k].along[j];
    }
    corners[k][0] = -1.0F * (corners[k][1] + corners[k][2] + corners[k][3]);
    for (int a = 0; a < 4; ++a) sums[a] = sums[a] + corners[k][a];
  }
  for (int a = 0; a < 4; ++a) u[a] = 4 * corners[a][a] - sums[a];
  for (int e = 0; e < 6; ++e) {
    const auto [i, j] = kEdgeEnds[e];
    u[4 + e] = 4 * (corners[i][j] + corners[j][i]);
  }
}

}  // namespace
}  // namespace palpate::deformation::kernel
