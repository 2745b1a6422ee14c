// What the springs of some nodes resist with while all others are held.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "deformation/model/patch.h"
#include "deformation/model/spring_network.h"

namespace palpate::deformation {

class PatchSprings {
 public:
  /// @param network  outlives this
  PatchSprings(const SpringNetwork& network, std::size_t node_count);

  /// Adds stiffness K and damping D of the patch at these positions [m] to the lower triangles of
  /// two matrices. Of the part across a spring only tension counts, as in
  /// projected_spring_stiffness.h.
  void add(const std::vector<Vec3>& positions, const Patch& patch, Eigen::MatrixXf& stiffness,
           Eigen::MatrixXf& damping) const;

 private:
  const SpringNetwork& network_;
  std::vector<std::uint32_t> starts_, springs_;  ///< of each node
};

}  // namespace palpate::deformation
