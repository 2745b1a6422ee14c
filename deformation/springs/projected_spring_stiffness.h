// How the forces of the spring network change with the velocities, for implicit steps.
//
// A spring with d = x_b − x_a, l = |d|, u = d/l pulls a with (k (l − l₀) + c (v_b − v_a)·u) u. If
// all velocities change by p at once and the positions by h p, that force changes by J (p_b − p_a):
//     J = (c + h k) u uᵀ + h k (1 − l₀/l)₊ (I − u uᵀ)
// Of the part across the spring only tension counts (Gauss–Newton): a compressed spring would push
// its ends aside, which makes J indefinite; without it J is no smaller than the true one, and the
// matrix of a step is symmetric and positive definite:
//     A = (1 + h·drag) M + h Σ_springs (e_a − e_b) J (e_a − e_b)ᵀ
// D. Baraff, A. Witkin, "Large Steps in Cloth Simulation", SIGGRAPH 1998; M. Choi & H. Ko, "Stable
// but Responsive Cloth", SIGGRAPH 2002 (no compression across).
//
// Each spring's block is positive semidefinite, so A ⪯ 2 D with D its 3×3 diagonal blocks.
//
// Kept in float: A only ever acts on corrections, whose error a later residual sees again.
#pragma once

#include <array>
#include <vector>

#include "deformation/model/body.h"
#include "deformation/model/spring_network.h"
#include "modules/core/simd_vectors.h"

namespace palpate::deformation {

class ProjectedSpringStiffness {
 public:
  /// @param body  outlives this
  ProjectedSpringStiffness(const Body& body, const SpringNetwork& network);

  /// Takes A at these positions [m] (node_count) for a step of h [s].
  void linearise(const std::vector<Vec3>& positions, double h);

  const std::vector<Mat3>& diagonal() const { return diagonal_; }  ///< D [kg]  (node_count)

  /// out = A p. Rows of fixed nodes are like any other: leave p zero there and ignore them.
  /// @param p    [m/s]  (node_count)
  /// @param out  [N·s]  (node_count)
  void apply(const std::vector<Vec4f>& p, std::vector<Vec4f>& out) const;

 private:
  struct Constants {
    float rest_length = 0, stiffness = 0, damping = 0;
  };
  /// h J = along d dᵀ + across I of a spring between a and b.
  struct Coupling {
    std::uint32_t a = 0, b = 0;
    float along = 0, across = 0;
  };
  /// Σ along d dᵀ by columns, and Σ across, of the springs of a node.
  struct NodeSum {
    std::array<Vec4f, 3> along{Vec4f::Zero(), Vec4f::Zero(), Vec4f::Zero()};
    float across = 0;
  };

  const Body& body_;
  std::vector<Constants> constants_;  ///< as the model's springs
  std::vector<Coupling> couplings_;   ///< likewise
  std::vector<Vec4f> positions_;      ///< from the first node, so that float has digits enough
  std::vector<float> masses_;         ///< (1 + h·drag) M
  std::vector<NodeSum> sums_;         ///< D without the masses
  std::vector<Mat3> diagonal_;
};

}  // namespace palpate::deformation
