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

/// What a point has of its own corner, and of all.
template <class Set>
constexpr auto kOwn = static_cast<typename Set::Number>(kNearCorner - kFarCorner);
template <class Set>
constexpr auto kCommon = static_cast<typename Set::Number>(kFarCorner);

template <class Set>
Vectors<Set> corner_derivative(const Vectors<Set> (&u)[10], int corner, int coordinate) {
  if (corner == coordinate) return 3 * u[corner];
  return plus(-u[coordinate], 4, u[kMiddle[corner][coordinate]]);
}

template <class Set>
void differentiate(const Vectors<Set> (&u)[10], Derivatives<Set> (&at)[4]) {
  Vectors<Set> sums[3];
  for (int k = 0; k < 4; ++k) {
    const Vectors<Set> first = corner_derivative(u, k, 0);
    for (int j = 0; j < 3; ++j) {
      const Vectors<Set> own = corner_derivative(u, k, j + 1) - first;
      sums[j] = k == 0 ? own : sums[j] + own;
      at[k].along[j] = own;
    }
  }
  for (int j = 0; j < 3; ++j) {
    const Vectors<Set> common = kCommon<Set> * sums[j];
    for (auto& point : at) point.along[j] = plus(common, kOwn<Set>, point.along[j]);
  }
}

/// The transpose.
template <class Set>
void integrate(const Derivatives<Set> (&at)[4], Vectors<Set> (&u)[10]) {
  Vectors<Set> sums[4], corners[4][4];  // of all corners: weights of a point add up to 1
  for (int j = 0; j < 3; ++j) {
    sums[j + 1] = (at[0].along[j] + at[1].along[j]) + (at[2].along[j] + at[3].along[j]);
    const Vectors<Set> common = kCommon<Set> * sums[j + 1];
    for (int k = 0; k < 4; ++k) {
      corners[k][j + 1] = plus(common, kOwn<Set>, at[k].along[j]);
    }
  }
  sums[0] = -(sums[1] + sums[2] + sums[3]);
  for (auto& own : corners) own[0] = -(own[1] + own[2] + own[3]);
  for (int a = 0; a < 4; ++a) u[a] = plus(-sums[a], 4, corners[a][a]);
  for (int e = 0; e < 6; ++e) {
    const auto [i, j] = kEdgeEnds[e];
    u[4 + e] = 4 * (corners[i][j] + corners[j][i]);
  }
}

}  // namespace
}  // namespace palpate::deformation::kernel
