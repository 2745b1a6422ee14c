#include "deformation/springs/patch_springs.h"

#include <algorithm>
#include <cmath>

#include "deformation/linear_algebra/node_block_matrix.h"

namespace palpate::deformation {

namespace {

constexpr float kTinyPatchSquare = 1e-20f;  // [m²]: no direction, no force

/// What moving an end of a spring is resisted with.
struct Resistance {
  Block4f stiffness, damping;
};

/// @param damping  axial [N·s/m]  @param d  from end to end [m]
Resistance resistance_of(const Spring& spring, double damping, const Vec4f& d) {
  const float square = d.squaredNorm();
  const Block4f none{Vec4f::Zero(), Vec4f::Zero(), Vec4f::Zero()};
  if (square < kTinyPatchSquare) return {none, none};
  const auto k = static_cast<float>(spring.stiffness);
  const float stretch = 1 - static_cast<float>(spring.rest_length) / std::sqrt(square);
  const float across = k * std::max(stretch, 0.0f);
  Block4f stiffness = outer(d, (k - across) / square * d);
  for (int axis = 0; axis < 3; ++axis) stiffness[static_cast<std::size_t>(axis)][axis] += across;
  return {stiffness, outer(d, static_cast<float>(damping) / square * d)};
}

void add_to(Block4f& sum, const Block4f& block) {
  for (std::size_t k = 0; k < 3; ++k) sum[k] += block[k];
}

/// Adds the block to rows 3 i … and columns 3 j ….
void add_at(Eigen::MatrixXf& sum, int i, int j, const Block4f& block, float share) {
  for (int axis = 0; axis < 3; ++axis) {
    sum.block<3, 1>(3 * i, 3 * j + axis) += share * block[static_cast<std::size_t>(axis)].head<3>();
  }
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
                       Eigen::MatrixXf& stiffness, Eigen::MatrixXf& damping) const {
  for (const std::uint32_t node : patch.nodes) {
    const int i = patch.place(node);
    const Block4f none{Vec4f::Zero(), Vec4f::Zero(), Vec4f::Zero()};
    Resistance own{none, none};  // of all its springs, kept in registers
    for (auto at = starts_[node]; at < starts_[node + 1]; ++at) {
      const Spring& spring = network_.springs[springs_[at]];
      const std::uint32_t other = spring.node_a == node ? spring.node_b : spring.node_a;
      const Resistance one = resistance_of(spring, network_.damping[springs_[at]],
                                           wide(positions[other] - positions[node]));
      add_to(own.stiffness, one.stiffness);
      add_to(own.damping, one.damping);
      const int j = patch.place(other);
      if (j < 0 || j >= i) continue;
      add_at(stiffness, i, j, one.stiffness, -1);
      add_at(damping, i, j, one.damping, -1);
    }
    add_at(stiffness, i, i, own.stiffness, 1);
    add_at(damping, i, i, own.damping, 1);
  }
}

}  // namespace palpate::deformation
