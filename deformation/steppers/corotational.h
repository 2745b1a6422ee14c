// Linear elasticity of tetrahedra in frames that turn with them:
//   F = R S,   P = 2μ (F − R) + λ tr(RᵀF − I) R,   f_a = −V P g_a       (g_a = ∇N_a at rest)
// M. Müller, M. Gross, "Interactive Virtual Materials", Graphics Interface 2004. In their frames,
// tetrahedra have constant stiffness; the turning of R is left out of it:
//   K_ab = V R (λ g_a g_bᵀ + μ g_b g_aᵀ + μ g_a·g_b I) Rᵀ
// Forces are linear in the strain, and wrong by about as much as that is. Turned inside out, a
// tetrahedron has R with det R = 1 nearest to F, and forces that turn it back.
//
// Linear tetrahedra lock as Poisson's ratio comes near to 1/2: nodal_pressure.h.
#pragma once

#include "deformation/elements/linear_tetrahedra.h"
#include "deformation/linear_algebra/implicit_solid_matrix.h"
#include "deformation/steppers/implicit_solid.h"

namespace palpate::deformation {

class Corotational : public ImplicitTissue {
 public:
  static constexpr int kIterations = 20;

  /// @param model  a solid, ν < 1/2; outlives this
  explicit Corotational(const OrganModel& model);

  void linearise(const std::vector<Vec3>& positions, double h) override;
  const std::vector<Vec3>& forces() const override { return forces_; }
  const std::vector<Mat3>& diagonal() const override { return diagonal_; }
  void apply(const std::vector<Vec4f>& p, std::vector<Vec4f>& out) override {
    matrix_.apply(p, out);
  }
  double energy(const std::vector<Vec3>& positions) override;

 private:
  void add_tetrahedron(std::size_t e, const std::vector<Vec3>& positions, float h2);

  const OrganModel& model_;
  LinearTetrahedra tetrahedra_;
  NodePairs pairs_;
  ImplicitSolidMatrix matrix_;
  double mu_, lambda_;
  std::vector<Vec3> forces_;
  std::vector<Mat3> diagonal_;
};

/// The rotation nearest to F: maximises tr(RᵀF) over det R = 1, whatever the sign of det F. As a
/// quaternion it is the eigenvector to the largest eigenvalue of a 4×4 matrix (B. Horn, J. Opt.
/// Soc. Am. A 4, 1987); the eigenvalue by Newton from above (D. Theobald, Acta Cryst. A61, 2005).
/// The identity if no rotation is nearer than all others (F = 0, mirrored about a point).
Mat3 nearest_rotation(const Mat3& F);

}  // namespace palpate::deformation
