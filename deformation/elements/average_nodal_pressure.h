// Linear tetrahedra that keep their volume without locking: shape is kept by each tetrahedron,
// volume by each node for the tetrahedra around it,
//   U = Σ_e V_e ψ(F_e) + Σ_a κ'/2 V_a (J_a − 1)²,   J_a = v_a/V_a,   v_a = Σ_{e∋a} v_e/4
// J. Bonet, A. Burton, "A simple average nodal pressure tetrahedral element for incompressible and
// nearly incompressible dynamic explicit applications", Commun. Numer. Meth. Engng 14, 1998. With
//   ψ(F) = μ/2 (tr FᵀF − 3) − μ (J − 1) + α/2 (J − 1)²       (materials/stable_neo_hookean.h)
// At J = 1 its stress is that of neo-Hookean tissue but for the pressure. α − μ/3 is the part of
// the bulk modulus that each tetrahedron keeps for itself, κ' the rest: without the first,
// pressures of neighbouring nodes oscillate (M. Puso, J. Solberg, Int. J. Numer. Meth. Engng 67,
// 2006).
//
// With b_a = ∂v_e/∂x_a and c_e = α (J_e − 1) − μ + Σ_{a∈e} κ' (J_a − 1)/4:
//   F_a = −μ Σ_e V_e (g_a·g_b) x_b − Σ_e c_e b_a
//   K   = μ Σ_e V_e (g_a·g_b) I + Σ_e (α/V_e b bᵀ + c_e ∂²v_e/∂x²) + Σ_a κ'/V_a (∂v_a)(∂v_a)ᵀ
// ∂²v/∂x² pushes as much as it pulls, −σ … 2σ of a tetrahedron's shape term for its largest stretch
// σ. In the matrix of a step c_e is limited to c' in −min(μ/σ, J (3α + μ/σ⁴)/2) … 0, which keeps K
// positive, and what that takes off is made up for by a shape term of θ = 2σ |c_e − c'|: then the
// matrix is no smaller than the forces' derivative in any direction, and Newton's iteration, one to
// a step, comes to rest. Limited only, it overshot under small indenters, and forces trembled. The
// last sum of K couples neighbours of neighbours; it is not assembled.
#pragma once

#include "deformation/elements/elastic_force_elements.h"
#include "deformation/elements/linear_tetrahedra.h"
#include "deformation/linear_algebra/node_block_matrix.h"
#include "deformation/materials/stable_neo_hookean.h"

namespace palpate::deformation {

/// What the method leaves open.
struct AverageNodalPressureSettings {
  double stabilisation = 0.5;         ///< α/μ ≥ 1/3
  double largest_bulk_modulus = 100;  ///< κ/μ is not taken above this: 100 is ν = 0.495
};

/// κ' [Pa]
double nodal_bulk_modulus(const ElasticConstants& tissue,
                          const AverageNodalPressureSettings& settings);

/// The plain code: nodal_pressure_kernel.h does the same fast.
class AverageNodalPressure : public ElasticForceElements {
 public:
  AverageNodalPressure(LinearTetrahedra tetrahedra, const ElasticConstants& tissue,
                       const AverageNodalPressureSettings& settings = {});

  void linearise(const std::vector<Vec3>& positions, double scale,
                 std::span<const double> shift) override;
  const std::vector<Vec3>& forces() const override { return forces_; }
  const std::vector<Mat3>& diagonal() const override { return diagonal_; }
  void apply(const std::vector<Vec4f>& p, std::vector<Vec4f>& out) override;
  void add_block(const Patch& patch, float share, Eigen::MatrixXf& sum) const override;
  ElementPressures pressures() const override {
    return {node_volumes_.size(), nodal_modulus_, law_.shear_modulus};
  }
  void take_pressures_of_shape(const std::vector<Vec3>& positions,
                               Eigen::VectorXd& pressures) override;
  void go_on_from(const Eigen::VectorXd& kept, const Eigen::VectorXd& shares) override;
  double energy(const std::vector<Vec3>& positions) override;

 private:
  void take_volumes(const std::vector<Vec3>& positions);
  void add_shape_forces(const std::vector<Vec3>& positions);
  void add_tetrahedron(std::size_t e, const std::vector<Vec3>& positions, double scale);
  /// c' of c. @param stretch  σ. @param J  v/V
  double kept_turning(double c, double stretch, double J) const;
  void add_pressures(double scale);

  LinearTetrahedra tetrahedra_;
  StableNeoHookean law_;  ///< of each tetrahedron: μ, α
  NodePairs pairs_;
  NodeBlockMatrix matrix_;
  double nodal_modulus_;                ///< κ' [Pa]
  std::vector<double> node_volumes_;    ///< V_a at rest [m³]
  std::vector<double> shape_weights_;   ///< Σ_e V_e g_a·g_b [m], by pair
  std::vector<Mat34> areas_;            ///< b, by tetrahedron [m²]
  std::vector<double> volumes_;         ///< v_e [m³]
  std::vector<double> node_pressures_;  ///< κ' (J_a − 1), positive when stretched [Pa]
  Eigen::VectorXd kept_;                ///< of the pressures of steps before [Pa]
  Eigen::VectorXd shares_;              ///< s of each node
  std::vector<Vec4f> volume_rows_;      ///< ∂v_a/∂x_b by pair, times √(scale κ'/V_a)
  std::vector<Vec3> forces_;
  std::vector<Mat3> diagonal_;
};

}  // namespace palpate::deformation
