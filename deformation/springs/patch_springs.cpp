#include "deformation/springs/patch_springs.h"

namespace palpate::deformation {

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
      const Vec3 along = positions[other] - positions[node];
      const double length = along.norm();
      if (length == 0) continue;
      const Vec3 u = along / length;
      const double stretch = 1 - spring.rest_length / length;
      const double across = stiffness_share * spring.stiffness * std::max(stretch, 0.0);
      const double own = stiffness_share * spring.stiffness +
                         damping_share * network_.damping[springs_[at]] - across;
      const Eigen::Matrix3f block =
          (own * u * u.transpose() + across * Mat3::Identity()).cast<float>();
      sum.block<3, 3>(3 * i, 3 * i) += block;
      const int j = patch.place(other);
      if (j >= 0 && j < i) sum.block<3, 3>(3 * i, 3 * j) -= block;
    }
  }
}

}  // namespace palpate::deformation
