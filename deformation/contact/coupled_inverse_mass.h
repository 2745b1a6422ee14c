// Contacts' couplings of the matrix of a step (tilts, friction) in the nodes' inverse masses.
#pragma once

#include <span>

#include "deformation/springs/spring_hessian_product.h"

namespace palpate::deformation {

/// Turns blocks W with A ⪯ W⁻¹ into such blocks of A plus the coupling's (Σ a_k·u_k)², which is at
/// most Σ_k |a_k| (Σ_j |a_j|) u_k² along the arms (Cauchy–Schwarz). A step down the gradient by W
/// still does not overshoot.
/// @param inverse_mass_blocks  W, zero for fixed nodes [1/kg]  (node_count)
void take_coupling(const ContactCoupling& coupling, std::span<Mat3> inverse_mass_blocks);

}  // namespace palpate::deformation
