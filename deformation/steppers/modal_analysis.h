// Small free vibration about rest: K̂ u = ω² M u, K̂ = K + B C⁻¹ Bᵀ, by subspace iteration.
//   K.-J. Bathe, E. Wilson, "Solution methods for eigenvalue problems in structural mechanics",
//   Int. J. Numer. Methods Eng. 6, 1973.
#pragma once

#include <functional>
#include <vector>

#include "deformation/elements/taylor_hood.h"

namespace palpate::deformation {

struct Eigenmodes {
  std::vector<double> angular_frequencies;  ///< ω ≥ 0, rising; rigid motions first as 0 [rad/s]
  Eigen::MatrixXd modes;                    ///< u, uᵀMu = 1  (3 · node_count × count)
  Eigen::MatrixXd momenta;                  ///< M u  (3 · node_count × count)
  Eigen::MatrixXd pressures;                ///< p that go with u  (corner_count × count)
};

/// The lowest modes. Stops when no ω² changes by more than 1e-8 of the highest one wanted.
/// @param constrained   as in QuasiStaticNewton
/// @param count  of modes wanted, ≥ 1, far fewer than coordinates
/// @param keep_going  as QuasiStaticNewton::solve()
/// @throws std::runtime_error if the iteration did not converge
Eigenmodes modal_analysis(
    const TaylorHoodElements& solid, const std::vector<char>& constrained, std::size_t count,
    const std::function<void()>& keep_going = [] {});

}  // namespace palpate::deformation
