// Projection onto velocities that change neither the volume nor any active contact.
//
// With rows B (the volume gradient g; per closed contact n, and two tangents if it sticks) and node
// mobilities W, the projection of a force r is
//     z = W (r − Bᵀμ),   B z = 0
// As preconditioner of conjugate gradients it keeps every iterate on the rows, however few
// iterations: N. Gould, M. Hribar, J. Nocedal, "On the Solution of Equality Constrained Quadratic
// Programming Problems Arising in Optimization", SIAM J. Sci. Comput. 2001. μ tells what the rows'
// impulses lack.
//
// The contact rows are sparse: S = C W Cᵀ is factored once per step. The volume row is dense and
// eliminated by the scalar division, as in contact_solve.h with the roles exchanged. Vectors over
// nodes are in float like the matrix they go with; what of a row that lets through is taken back
// when contact_solve.h has the last word.
#pragma once

#include <Eigen/SparseCholesky>
#include <span>
#include <vector>

#include "deformation/contact_solve.h"
#include "deformation/wide_vectors.h"

namespace palpate::deformation {

class ConstraintProjection {
 public:
  /// Takes as active the contacts with a normal impulse; those below the cone stick.
  /// @param mobilities  W, zero for fixed nodes [1/kg]  (node_count)
  /// @param gradient    g [m²]  (surface_node_count); empty: no volume row
  void prepare(std::span<const Mat3> mobilities, std::span<const Vec3> gradient,
               std::span<const ContactRow> contacts);

  /// @param r  [N·s]  (node_count)
  /// @param z  out [m/s]  (node_count)
  void project(const std::vector<Vec4f>& r, std::vector<Vec4f>& z);

  /// Subtracts from r the Bᵀμ of the last project(), and adds μ to the impulses.
  void take_impulses(std::span<ContactRow> contacts, double& volume_impulse,
                     std::vector<Vec4f>& r) const;

 private:
  /// One scalar row of C: Σ_k weight_k direction·v_k.
  struct Row {
    std::size_t contact = 0;
    std::array<std::uint32_t, 3> nodes{};
    Vec3 weights = Vec3::Zero(), direction = Vec3::Zero();
    bool normal = false;
  };

  void take_mobilities(std::span<const Mat3> mobilities);
  void collect_rows(std::span<const Mat3> mobilities, std::span<const ContactRow> contacts);
  void factor_contacts(std::span<const Mat3> mobilities);
  void prepare_volume(std::span<const Vec3> gradient);
  Vec4f answer(std::size_t node, const Vec4f& impulse) const;     ///< W impulse
  Eigen::VectorXd times_rows(const std::vector<Vec4f>& v) const;  ///< C v
  /// z −= W Cᵀ μ
  void subtract_rows(const Eigen::VectorXd& mu, std::vector<Vec4f>& z) const;

  std::vector<std::array<Vec4f, 3>> mobilities_;  ///< W, by columns
  std::vector<Vec4f> gradient_;                   ///< g; empty: no volume row
  std::vector<Row> rows_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor_;  ///< of S
  std::vector<Vec4f> volume_answer_;  ///< W (g − Cᵀ S⁻¹ C W g), the velocity a pressure gives
  Eigen::VectorXd volume_shares_;     ///< S⁻¹ C W g: what of it the contacts take
  double volume_mobility_ = 0;        ///< g · volume_answer_; 0: no volume row
  Eigen::VectorXd mu_;
  double volume_mu_ = 0;
};

}  // namespace palpate::deformation
