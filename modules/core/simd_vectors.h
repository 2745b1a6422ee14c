// Vectors over nodes in float, four to a node so that a node fills a register: for the inner
// iterations of implicit steps.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "modules/core/types.h"

namespace palpate::deformation {

/// x, y, z and a zero.
using Vec4f = Eigen::Vector4f;

inline Vec4f wide(const Vec3& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z()), 0};
}

/// A node and the vector a matrix is to be applied to: what a product loads at once.
struct WideNode {
  Vec4f position = Vec4f::Zero(), vector = Vec4f::Zero();
};

/// Nodes summed in float; in double over those.
inline constexpr std::size_t kDotBlock = 32;

/// a·b over the nodes of a.
inline double dot(const std::vector<Vec4f>& a, const std::vector<Vec4f>& b) {
  double sum = 0;
  for (std::size_t first = 0; first < a.size(); first += kDotBlock) {
    Vec4f block = Vec4f::Zero();
    const std::size_t end = std::min(first + kDotBlock, a.size());
    for (std::size_t i = first; i < end; ++i) block += a[i].cwiseProduct(b[i]);
    sum += block.sum();
  }
  return sum;
}

/// a += scale · b
inline void add(double scale, const std::vector<Vec4f>& b, std::vector<Vec4f>& a) {
  const auto factor = static_cast<float>(scale);
  for (std::size_t i = 0; i < a.size(); ++i) a[i] += factor * b[i];
}

/// What a step of conjugate gradients leaves.
struct Gone {
  double descent = 0;  ///< r·z
  double change = 0;   ///< q·z
};

/// x += length · d, r −= length · q, z = P r, in one pass and summed as dot() does.
/// @param P  a 3×3 block for each node, by columns
inline Gone go_along(double length, const std::vector<Vec4f>& d, const std::vector<Vec4f>& q,
                     const std::vector<std::array<Vec4f, 3>>& P, std::vector<Vec4f>& x,
                     std::vector<Vec4f>& r, std::vector<Vec4f>& z) {
  const auto along = static_cast<float>(length);
  Gone gone;
  for (std::size_t first = 0; first < x.size(); first += kDotBlock) {
    Vec4f descent = Vec4f::Zero(), change = Vec4f::Zero();
    for (std::size_t i = first; i < std::min(first + kDotBlock, x.size()); ++i) {
      x[i] += along * d[i];
      const Vec4f rest = r[i] - along * q[i];
      const Vec4f next = rest[0] * P[i][0] + rest[1] * P[i][1] + rest[2] * P[i][2];
      r[i] = rest;
      z[i] = next;
      descent += rest.cwiseProduct(next);
      change += q[i].cwiseProduct(next);
    }
    gone.descent += descent.sum();
    gone.change += change.sum();
  }
  return gone;
}

}  // namespace palpate::deformation
