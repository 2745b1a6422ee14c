// Incompressible fluid that fills the cavity of a solid: a pressure on the cavity's wall, of the
// size at which the cavity's volume is that at rest.
//
// It adds −p (V − V₀) to the energy, p > 0 outward, one unknown p for all of it:
//   r_a −= p ∂V/∂x_a,   r_p = V₀ − V
// V is a sum over faces, ⅓ ∫ x·(∂x/∂L₁ × ∂x/∂L₂), which six points integrate exactly; each face's
// part is differentiated as it is, so that its second derivative is symmetric without the others.
#pragma once

#include <vector>

#include "deformation/elements/taylor_hood.h"

namespace palpate::deformation {

class EnclosedFluid {
 public:
  /// @param solid  outlives this
  /// @param faces  of its mesh that the fluid touches: indices into mesh().faces. Where they do not
  ///               close, what closes them is to lie in planes through the origin.
  EnclosedFluid(const TaylorHoodElements& solid, std::vector<std::uint32_t> faces);

  /// Of state.fluid_pressure.
  void add_residual(std::size_t element, const SolidState& state, ElementVector& residual) const;
  void add_tangent(std::size_t element, const SolidState& state, ElementMatrix& tangent) const;

  double volume(const SolidState& state) const;  ///< V [m³]
  double rest_volume() const { return rest_volume_; }
  /// −∂V/∂x for every unknown of the solid, 0 for its pressures [m²].
  Eigen::VectorXd gradient(const SolidState& state) const;

 private:
  /// Of one face, 3 coordinates per node; the solid's own side, so that it falls as V grows.
  using FaceVector = Eigen::Matrix<double, 3, kFaceNodes>;
  FaceVector gradient(const BoundaryFace& face, const SolidState& state) const;

  const TaylorHoodElements& solid_;
  std::vector<std::uint32_t> faces_;
  std::vector<std::vector<std::uint32_t>> of_element_;  ///< faces of each
  double rest_volume_ = 0;
};

/// Faces of cavities: of the closed surfaces that the boundary falls into, those whose outward side
/// is within.
std::vector<std::uint32_t> cavity_faces(const QuadraticMesh& mesh);

}  // namespace palpate::deformation
