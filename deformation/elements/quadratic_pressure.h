// Quadratic tetrahedra that keep their volume without locking, for implicit steps: positions are
// quadratic in each (ten nodes), the pressure is constant (P2/P0) and eliminated,
//   U = Σ_e Σ_q V_e/4 ψ(F_q) + Σ_e κ'/2 V_e (J̄_e − 1)²,   J̄_e = Σ_q J_q/4
// over the four points q of an element, with ψ and κ' = κ − (α − μ/3) as in
// average_nodal_pressure.h: at J = 1 its stress is that of neo-Hookean tissue but for the pressure.
//   M. Crouzeix, P.-A. Raviart, RAIRO 7, 1973 (the pair); M. Crisfield, Non-linear Finite Element
//   Analysis of Solids and Structures 2, 1997 (mean dilatation)
//
// With g_a = ∇N_a at a point, b_a = ∂J/∂x_a and c = α (J − 1) − μ + κ' (J̄ − 1):
//   F_a = −Σ V/4 (μ F g_a + c b_a)
//   K   = Σ V/4 (μ (g_a·g_b) I + α b bᵀ + c ∂²J/∂x²) + Σ_e κ' V ∂J̄ ∂J̄ᵀ
// In the matrix of a step c is limited to c', and what that takes off is made up for, point by
// point, as average_nodal_pressure.h says: so K is positive, and no smaller than the forces'
// derivative.
//
// A is not assembled. A product visits the tetrahedra, sixteen side by side (quadratic_kernel/),
// and costs about what reading an assembled A would. Elements are straight at rest.
#pragma once

#include "deformation/elements/elastic_force_elements.h"
#include "deformation/elements/quadratic_kernel/quadratic_arrays.h"
#include "deformation/materials/stable_neo_hookean.h"
#include "deformation/model/tet_mesh.h"
#include "deformation/packs/instruction_set.h"
#include "modules/core/aligned_vector.h"

namespace palpate::deformation {

class QuadraticPressure : public ElasticForceElements {
 public:
  /// κ/μ is not taken above this: 100 is ν = 0.495.
  static constexpr double kLargestBulkModulus = 100;
  /// α/μ ≥ 1/3, the part of the bulk modulus that each point keeps for itself. More of it lets the
  /// matrix limit c less and makes elements stiffer.
  static constexpr double kPointModulus = 0.4;

  /// @param mesh  quadratic
  QuadraticPressure(const std::vector<Vec3>& rest_positions, const TetMesh& mesh,
                    InstructionSet set = available_instruction_sets().back());

  void linearise(const std::vector<Vec3>& positions, double scale,
                 std::span<const double> shift) override;
  ElementPressures pressures() const override {
    return {elements_.size(), bulk_modulus_, law_.shear_modulus};
  }
  void take_pressures_of_shape(const std::vector<Vec3>& positions,
                               Eigen::VectorXd& pressures) override;
  void go_on_from(const Eigen::VectorXd& kept, const Eigen::VectorXd& shares) override;
  const std::vector<Vec3>& forces() const override { return forces_; }
  const std::vector<Mat3>& diagonal() const override { return diagonal_; }
  void apply(const std::vector<Vec4f>& p, std::vector<Vec4f>& out) override;
  void add_block(const Patch& patch, float share, Eigen::MatrixXf& sum) const override;
  double energy(const std::vector<Vec3>& positions) override;

 private:
  using Nodes = std::array<std::uint32_t, 10>;

  void add_element(std::size_t e, const std::vector<Vec3>& rest_positions, const TetMesh& mesh);
  kernel::QuadraticPass begin_pass();
  void add_element_block(std::size_t e, const Patch& patch, float share,
                         Eigen::MatrixXf& sum) const;

  StableNeoHookean law_;  ///< of each point: μ, α
  double bulk_modulus_;   ///< κ' [Pa]
  kernel::QuadraticKernel kernel_;
  AlignedVector<kernel::QuadraticBatch> batches_;  ///< element e: lane e / size() of e mod size()
  std::vector<Nodes> elements_;
  std::vector<std::uint32_t> first_element_;  ///< of each node, in elements_of_nodes_
  std::vector<std::uint32_t> elements_of_nodes_;
  double scale_ = 0;          ///< of the last linearise() [s²]
  std::vector<float> shift_;  ///< of the same [kg]
  std::vector<Vec4f> wide_forces_;
  std::vector<Vec4f> wide_diagonal_, wide_mixed_z_;
  std::vector<double> energies_;  ///< buffer of energy()
  std::vector<Vec3> forces_;
  std::vector<Mat3> diagonal_;
};

}  // namespace palpate::deformation
