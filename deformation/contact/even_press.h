// What a patch gives way by, in explicit steps, to a press that moves evenly through a period.
//
// C A⁻¹ Cᵀ (patch_compliance.h) takes all nodes to move evenly. Those that are touched do, with the
// probe; their neighbours start from rest and follow late, by half of that or less, so that they
// resist more. Symplectic Euler of the patch, linear about where it is,
//     v⁺ = v + h (M⁻¹ (f − K x − D v) − drag v) − M⁻¹ g σ,   g·v⁺ = 0,   x⁺ = x + h v⁺,
// pushed in its first step alone, answers with a_1, a_2, … at the push's own place; the forces p_i
// that move it evenly follow from Σ_i<j a_(j−i) p_i = j/n, and their mean tells.
#pragma once

#include <Eigen/Core>

namespace palpate::deformation {

/// All three numbers a node. No volume is kept where volume and volume_beyond are zero.
struct PressedPatch {
  Eigen::MatrixXf stiffness;  ///< K, its lower triangle [N/m]
  Eigen::MatrixXf damping;    ///< D, likewise [N·s/m]
  Eigen::VectorXd masses;     ///< M [kg]
  Eigen::VectorXd push;       ///< how the press shares: forces whose work its way is of
  Eigen::VectorXd volume;     ///< g [m²]
  double volume_beyond = 0;   ///< gᵀM⁻¹g of free nodes beyond [m⁴/kg]
  double drag = 0;            ///< [1/s]
};

/// @param period  [s]  @param steps  ≥ 1, stable
/// @returns way at the period's end over the mean force [m/N]; not positive from a bad state
double even_press_compliance(const PressedPatch& patch, double period, int steps);

}  // namespace palpate::deformation
