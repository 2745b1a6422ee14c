#include "deformation/springs/patch_springs.h"

#include <algorithm>
#include <cmath>

#include "deformation/linear_algebra/node_block_matrix.h"

namespace palpate::deformation {

namespace {

constexpr float kTinySquare = 1e-20f;  // [m²]: no direction, no force

/// What moving an end of a spring is resisted with; d from end to end [m].
Block4f block_of(const Spring& spring, double spring_damping, const Vec4f& d, double stiffness,
                 double damping) {
  const float square = d.squaredNorm();
  if (square < kTinySquare) return {Vec4f::Zero(), Vec4f::Zero(), Vec4f::Zero()};
  const auto k = static_cast<float>(stiffness * spring.stiffness);
  const float stretch = 1 - static_cast<float>(spring.rest_length) / std::sqrt(square);
  const float across = k * std::max(stretch, 0.0f);
  const float along = (k + static_cast<float>(damping * spring_damping) - across) / square;
  const Vec4f scaled = along * d;
  Block4f block{scaled.x() * d, scaled.y() * d, scaled.z() * d};
  for (int axis = 0; axis < 3; ++axis) block[static_cast<std::size_t>(axis)][axis] += across;
  return block;
}

}  // namespace

PatchSprings::PatchSprings(const SpringNetwork& network, std::size_t node_count)
    : network_(network), starts_(node_count + 1, 0) {
  for (const Spring& spring : network.springs) {
    ++starts_[spring.node_a + 1];
    ++starts_[spring.node_b + 1];
  }
  for (std::size_t i = 0; i < node_count; ++i) starts_[i + 1] += starts_[i];
  springs_.resize(starts_.back());
  std::vector<std::uint32_t> next(starts_.begin(), starts_.end() - 1);
  for (std::uint32_t s = 0; s < network.springs.size(); ++s) {
    springs_[next[network.springs[s].node_a]++] = s;
    springs_[next[network.springs[s].node_b]++] = s;
  }
}

void PatchSprings::add(const std::vector<Vec3>& positions, const Patch& patch,
                       double stiffness_share, double damping_share, Eigen::MatrixXf& sum) const {
  for (const std::uint32_t node : patch.nodes) {
    const int i = patch.place(node);
    for (auto at = starts_[node]; at < starts_[node + 1]; ++at) {
      const Spring& spring = network_.springs[springs_[at]];
      const std::uint32_t other = spring.node_a == node ? spring.node_b : spring.node_a;
      const Block4f block =
          block_of(spring, network_.damping[springs_[at]], wide(positions[other] - positions[node]),
                   stiffness_share, damping_share);
      const int j = patch.place(other);
      for (int axis = 0; axis < 3; ++axis) {
        const auto column = block[static_cast<std::size_t>(axis)].head<3>();
        sum.block<3, 1>(3 * i, 3 * i + axis) += column;
        if (j >= 0 && j < i) sum.block<3, 1>(3 * i, 3 * j + axis) -= column;
      }
    }
  }
}

}  // namespace palpate::deformation
