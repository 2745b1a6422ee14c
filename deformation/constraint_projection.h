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

#include "deformation/aligned_vector.h"
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
  /// @returns r·z
  double project(const std::vector<Vec4f>& r, std::vector<Vec4f>& z);

  /// A step of conjugate gradients in one pass: x += step p, r −= step q, and z of the new r but
  /// for what the volume row takes from it. p are the nodes' vectors.
  /// @returns r·z
  double descend(double step, const AlignedVector<WideNode>& p, const std::vector<Vec4f>& q,
                 std::vector<Vec4f>& x, std::vector<Vec4f>& r, std::vector<Vec4f>& z);

  /// p = z + kept p, with what the volume row takes from z.
  void turn(double kept, const std::vector<Vec4f>& z, AlignedVector<WideNode>& p) const;

  /// Subtracts from r the Bᵀμ of the last projection, and adds μ to the impulses.
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
  /// Sums over the nodes of z = W r.
  struct Sums {
    double r_z = 0, g_z = 0;
  };
  /// Takes from z = W r what the contacts take, and finds μ. @returns r·z, the volume's part taken
  double hold_rows(const Sums& sums, std::vector<Vec4f>& z);
  Vec4f answer(std::size_t node, const Vec4f& impulse) const;     ///< W impulse
  Eigen::VectorXd times_rows(const std::vector<Vec4f>& v) const;  ///< C v
  /// z −= W Cᵀ μ
  void subtract_rows(const Eigen::VectorXd& mu, std::vector<Vec4f>& z) const;

  std::vector<std::array<Vec4f, 3>> mobilities_;  ///< W, by columns
  std::vector<Vec4f> gradient_;                   ///< g, zero beyond the surface (node_count)
  std::vector<Row> rows_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor_;  ///< of S
  std::vector<Vec4f> volume_answer_;  ///< W (g − Cᵀ S⁻¹ C W g), the velocity a pressure gives
  Eigen::VectorXd volume_shares_;     ///< S⁻¹ C W g: what of it the contacts take
  double volume_mobility_ = 0;        ///< g · volume_answer_; 0: no volume row
  Eigen::VectorXd mu_, row_speeds_;   ///< of the last projection; C W r
  double volume_mu_ = 0;
};

}  // namespace palpate::deformation
