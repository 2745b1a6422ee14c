// A round probe's contacts resist that the triangles they are on tilt.
//
// A contact is where its triangle comes nearest to the core. Tilted by an angle ε the triangle is
// touched d ε further on, d the distance to the core, where the same force j/h pushes back with
// j d/h per angle: the distance's second derivative times the force, the geometric part of a
// contact's stiffness (P. Wriggers, "Computational Contact Mechanics", 2006). With u = n·x of the
// corners the tilt is ∇u on the triangle, or the slope along an edge that is touched; in the matrix
// of a step of h, with h² times stiffnesses,
//     h j d |∇u|²,   |∇u|² = Σ_edges cot(opposite angle)/(2 area) (u_a − u_b)²
// Negative cotangents are left out, so the sum is no smaller than that.
//
// A soft wall of fine triangles resists tilting by little else. With planes that are found at a
// step's start and this left out, triangles under a fingertip overshoot from step to step.
#pragma once

#include <span>
#include <vector>

#include "deformation/contact/contact_solve.h"
#include "deformation/springs/spring_hessian_product.h"

namespace palpate::deformation {

/// Appends the couplings of the rows of round probes that press.
/// @param positions  where the rows were found [m]  (node_count)
void append_tilt_couplings(std::span<const ContactRow> rows, const std::vector<Vec3>& positions,
                           double h, std::vector<ContactCoupling>& couplings);

}  // namespace palpate::deformation
