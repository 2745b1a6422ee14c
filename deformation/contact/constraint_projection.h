// Projection onto velocities that change neither the volume nor any active contact.
//
// With rows B (the volume gradient g, and n of each closed contact) and the nodes' inverse mass
// blocks W, the projection of a force r is
//     z = W (r − Bᵀμ),   B z = 0
// As preconditioner of conjugate gradients it keeps every iterate on the rows, however few
// iterations: N. Gould, M. Hribar, J. Nocedal, "On the Solution of Equality Constrained Quadratic
// Programming Problems Arising in Optimization", SIAM J. Sci. Comput. 2001. μ tells what the rows'
// impulses lack.
//
// With every projection r gives Bᵀμ away (their residual update). Left in r it would outgrow all
// else as the iterations converge, and r·z would be rounding: a step of r·z / p·A p along it has no
// bound. In short steps, where A is nearly diagonal, one iteration is enough for that.
//
// The contact rows are sparse: S = C W Cᵀ is factored once per step. The volume row is dense and
// eliminated by the scalar division, as in contact_solve.h with the roles exchanged. Vectors over
// nodes are in float, like the matrix they go with; what a row lets through by that is taken back
// when contact_solve.h has the last word.
#pragma once

#include <Eigen/SparseCholesky>
#include <span>
#include <vector>

#include "deformation/contact/contact_solve.h"
#include "modules/core/aligned_vector.h"
#include "modules/core/ranges.h"
#include "modules/core/simd_vectors.h"

namespace palpate::deformation {

class ConstraintProjection {
 public:
  /// @param runner  outlives this; none: the calling thread alone. The bits are the same
  explicit ConstraintProjection(ChunkRunner* runner = nullptr) : ranges_(runner) {}

  /// Takes as active the contacts with a normal impulse, but those that yield: their impulse stays.
  /// @param inverse_mass_blocks  W, zero for fixed nodes [1/kg]  (node_count)
  /// @param gradient    g [m²]  (surface_node_count); empty: no volume row
  void prepare(std::span<const Mat3> inverse_mass_blocks, std::span<const Vec3> gradient,
               std::span<const ContactRow> contacts);

  /// @param r  loses what the rows take, but for what the volume row takes at last [N·s]
  ///           (node_count)
  /// @param z  out [m/s]  (node_count)
  /// @returns r·z
  double project(std::vector<Vec4f>& r, std::vector<Vec4f>& z);

  /// A step of conjugate gradients in one pass: x += step p, r −= step q and what the volume row
  /// took before, z of the new r but for what the volume row takes from it, and r less what the
  /// contacts take. p are the nodes' vectors.
  /// @returns r·z
  double descend(double step, const AlignedVector<WideNode>& p, const std::vector<Vec4f>& q,
                 std::vector<Vec4f>& x, std::vector<Vec4f>& r, std::vector<Vec4f>& z);

  /// p = z + kept p, with what the volume row takes from z.
  void turn(double kept, const std::vector<Vec4f>& z, AlignedVector<WideNode>& p) const;

  /// Adds to the impulses the μ of all projections since prepare(), and takes from r what the
  /// volume row took at last.
  void take_impulses(std::span<ContactRow> contacts, double& volume_impulse, std::vector<Vec4f>& r);

 private:
  /// A row of C: Σ_k weight_k normal·v_k.
  struct Row {
    std::size_t contact = 0;
    std::array<std::uint32_t, 3> nodes{};
    Vec3 weights = Vec3::Zero(), normal = Vec3::Zero();
  };

  void take_inverse_masses(std::span<const Mat3> inverse_mass_blocks);
  void collect_rows(std::span<const Mat3> inverse_mass_blocks,
                    std::span<const ContactRow> contacts);
  void factor_contacts(std::span<const Mat3> inverse_mass_blocks);
  void prepare_volume(std::span<const Vec3> gradient);
  /// Sums over the nodes of z = W r.
  struct Sums {
    double r_z = 0, g_z = 0;
  };
  /// Takes from r and z = W r what the contacts take, and finds μ.
  /// @returns r·z, the volume's part taken
  double hold_rows(const Sums& sums, std::vector<Vec4f>& r, std::vector<Vec4f>& z);
  /// W impulse
  Vec4f apply_inverse_mass(std::size_t node, const Vec4f& impulse) const {
    const auto& w = inverse_mass_blocks_[node];
    return w[0] * impulse[0] + w[1] * impulse[1] + w[2] * impulse[2];
  }
  Eigen::VectorXd times_rows(const std::vector<Vec4f>& v) const;  ///< C v
  /// r −= Cᵀ μ and z −= W Cᵀ μ
  void subtract_rows(const Eigen::VectorXd& mu, std::vector<Vec4f>& r, std::vector<Vec4f>& z) const;

  Sums sums_of(const std::vector<Vec4f>& r, const std::vector<Vec4f>& z);

  Ranges ranges_;
  std::vector<std::array<Vec4f, 3>> inverse_mass_blocks_;  ///< W, by columns
  std::vector<Row> rows_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor_;  ///< of S
  Eigen::VectorXd volume_shares_;       ///< S⁻¹ C W g: what of the volume row the contacts take
  std::vector<Vec4f> gradient_;         ///< g' = g − Cᵀ S⁻¹ C W g  (node_count)
  std::vector<Vec4f> volume_response_;  ///< W g', the velocity a pressure gives
  double volume_inverse_mass_ = 0;      ///< g' · W g'; 0: no volume row
  double volume_mu_ = 0;                ///< of the last projection, still in r
  // Since prepare():
  Eigen::VectorXd all_mu_;  ///< without the volume row's shares
  double all_volume_mu_ = 0;
};

/// A x = r on the rows, for conjugate_gradients.h.
/// @tparam Product  of A and the vectors p of its nodes(): apply(q), q = A p, returns p·q
template <class Product>
struct ProjectedSystem {
  ConstraintProjection& projection;
  Product& A;
  std::vector<Vec4f>&x, &r, &z, &q;

  double begin() {
    const double descent = projection.project(r, z);
    for (std::size_t i = 0; i < z.size(); ++i) A.nodes()[i].vector = z[i];
    return descent;
  }
  double curvature() { return A.apply(q); }
  double descend(double a) { return projection.descend(a, A.nodes(), q, x, r, z); }
  void turn(double b) { projection.turn(b, z, A.nodes()); }
};

}  // namespace palpate::deformation
