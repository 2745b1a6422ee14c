// Linear tetrahedra of corotated linear tissue (materials/corotated_linear.h):
//   f_a = −V P g_a       (g_a = ∇N_a at rest)
// and, with the turning of R left out as in M. Müller, M. Gross, "Interactive Virtual Materials",
// Graphics Interface 2004, where tetrahedra have constant stiffness in frames that turn,
//   K_ab = V R (λ g_a g_bᵀ + μ g_b g_aᵀ + μ g_a·g_b I) Rᵀ
//
// Linear tetrahedra lock as Poisson's ratio comes near to 1/2: average_nodal_pressure.h.
#pragma once

#include "deformation/elements/elastic_force_elements.h"
#include "deformation/elements/linear_tetrahedra.h"
#include "deformation/linear_algebra/node_block_matrix.h"
#include "deformation/materials/corotated_linear.h"

namespace palpate::deformation {

/// The plain code: corotational_kernel.h does the same fast.
class Corotational : public ElasticForceElements {
 public:
  /// @param tissue  ν < 1/2
  Corotational(LinearTetrahedra tetrahedra, const ElasticConstants& tissue);

  void linearise(const std::vector<Vec3>& positions, double scale,
                 std::span<const double> shift) override;
  const std::vector<Vec3>& forces() const override { return forces_; }
  const std::vector<Mat3>& diagonal() const override { return diagonal_; }
  void apply(const std::vector<Vec4f>& p, std::vector<Vec4f>& out) override {
    matrix_.apply(p, out);
  }
  void add_block(const Patch& patch, float share, Eigen::MatrixXf& sum) const override {
    matrix_.add_block(patch, share, sum);
  }
  double energy(const std::vector<Vec3>& positions) override;

 private:
  void add_tetrahedron(std::size_t e, const std::vector<Vec3>& positions, float scale);

  LinearTetrahedra tetrahedra_;
  CorotatedLinear law_;
  NodePairs pairs_;
  NodeBlockMatrix matrix_;
  std::vector<Vec3> forces_;
  std::vector<Mat3> diagonal_;
};

}  // namespace palpate::deformation
