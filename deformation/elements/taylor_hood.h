// Nearly or fully incompressible solid: quadratic displacement, linear continuous pressure
// (P2/P1). C. Taylor, P. Hood, Comput. Fluids 1, 1973; stable in the sense of Brezzi and Babuška,
// so it does not lock however incompressible the tissue.
//
// Equilibrium is the saddle point, lowest in the positions x, highest in the pressures p, of
//   L(x, p) = ∫ ψ(F) + p (J − 1) − p²/(2κ) dV₀ − (work of the loads)
//   r_a = ∂L/∂x_a = ∫ (P(F) + p ∂J/∂F) ∇N_a dV₀          [N]
//   r_m = ∂L/∂p_m = ∫ L_m (J − 1 − p/κ) dV₀                  [m³]
// p > 0 is tension; what a gauge shows is −p. The tangent [K B; Bᵀ −C] is symmetric, and
// quasi-definite while K is positive.
//
// Integrals: four points, exact for straight elements and small strain. Elements whose edge nodes
// lie on a curved boundary are isoparametric.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "deformation/elements/quadratic_mesh.h"
#include "deformation/materials/isochoric_neo_hookean.h"

namespace palpate::deformation {

/// Unknowns of an element: 3 coordinates of 10 nodes, then 4 pressures.
inline constexpr int kElementDofs = 3 * kElementNodes + 4;
using ElementVector = Eigen::Matrix<double, kElementDofs, 1>;
using ElementMatrix = Eigen::Matrix<double, kElementDofs, kElementDofs>;
using ElementMass = Eigen::Matrix<double, kElementNodes, kElementNodes>;

/// One integration point of an element.
struct ElementPoint {
  Eigen::Matrix<double, kElementNodes, 3> gradient;  ///< ∇N_a at rest [1/m]
  double volume = 0;                                 ///< it stands for [m³]
};

struct SolidState {
  std::vector<Vec3> positions;  ///< [m]  (node_count)
  Eigen::VectorXd pressures;    ///< p [Pa]  (corner_count)
  double fluid_pressure = 0;    ///< of what fills its cavity, see EnclosedFluid [Pa]
};

class TaylorHoodElements {
 public:
  /// @param density  ρ > 0 [kg/m³]
  /// @throws InputError naming the element if one is inside out
  TaylorHoodElements(QuadraticMesh mesh, const ElasticConstants& tissue, double density);

  const QuadraticMesh& mesh() const { return mesh_; }
  const ElasticConstants& tissue() const { return tissue_; }
  std::size_t element_count() const { return mesh_.elements.size(); }
  std::size_t displacement_count() const { return 3 * mesh_.nodes.size(); }
  /// All unknowns: displacements of the nodes, then pressures of the corners.
  std::size_t dof_count() const { return displacement_count() + mesh_.corner_count; }
  std::array<int, kElementDofs> dofs(std::size_t element) const;
  double density() const { return density_; }  ///< [kg/m³]
  double size() const { return size_; }        ///< diagonal of the bounding box [m]

  SolidState rest_state() const;

  /// (r_a, r_m) of one element. @returns false, and no residual, if J ≤ 0 at a point
  bool residual(std::size_t element, const SolidState& state, ElementVector& residual) const;

  /// [K B; Bᵀ −C] of one element. C is that of at least kLeastInverseBulk/μ: where that is more
  /// than 1/κ, Newton becomes an augmented Lagrangian iteration whose error falls by about that
  /// factor.
  /// @param state     J > 0
  /// @param positive  the stiffness of each point without its negative eigenvalues, so that K is
  ///                  positive semidefinite (J. Teran et al., "Robust quasistatic finite elements
  ///                  and flesh simulation", SCA 2005): slower to converge, but never uphill
  void tangent(std::size_t element, const SolidState& state, ElementMatrix& tangent,
               bool positive = false) const;
  static constexpr double kLeastInverseBulk = 1e-7;

  /// ∫ ρ N_a N_b dV₀ [kg], consistent; each coordinate alike.
  ElementMass mass(std::size_t element) const;

  /// ∫ J dV₀ [m³]
  double volume(const SolidState& state) const;
  /// ∫ ψ + κ/2 (J−1)² dV₀ with p = κ(J−1) projected [J].
  double energy(const SolidState& state) const;

 private:
  Mat3 deformation_gradient(std::size_t element, const ElementPoint& point,
                            const SolidState& state) const;
  double pressure(std::size_t element, int point, const SolidState& state) const;

  QuadraticMesh mesh_;
  ElasticConstants tissue_;
  IsochoricNeoHookean law_;
  double inverse_bulk_modulus_;  ///< 1/κ [1/Pa]
  double density_ = 0, size_ = 0;
  std::vector<std::array<ElementPoint, 4>> points_;
};

}  // namespace palpate::deformation
