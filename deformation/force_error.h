// How much of the force under a probe comes of the mesh's size, estimated from the deformed mesh
// alone.
//
// Where a probe is pushed in, the mesh is stiffer than the tissue, and by as much as its energy is
// too large: with F = dU/dδ the force is too large by the share that energy is. In the norm of
// energy the error of strains is orthogonal to them, so U_h − U is the error's own energy, and that
// is estimated by what a smoother field differs:
//   η² = Σ_e ∫ μ/2 ‖F* − F‖² dV,   F* linear between the means of F about each corner
//   O. Zienkiewicz, J. Zhu, "A simple error estimator and adaptive procedure for practical
//   engineering analysis", Int. J. Numer. Meth. Engng 24, 1987
// over U, both of the tetrahedra near the touch. What a far too coarse mesh does not see cannot be
// estimated from it, so under a round probe it is no less than what edges as long gave elsewhere
// (force_error_of_edge()). docs/accuracy.md has what it is against the truth.
#pragma once

#include "deformation/contact/probe_contacts.h"
#include "deformation/model/organ_model.h"

namespace palpate::deformation {

/// Part of a solid near a touch, at rest.
struct TouchedPart {
  Vec3 centre = Vec3::Zero();  ///< [m]
  double reach = 0;            ///< of the part about it [m]
  double edge = 0;             ///< mean length where it presses [m]
  double probe_radius = 0;     ///< of a round probe, else 0 [m]
};

/// Where a probe pressed on an organ in its last advance: five times as far as its contacts and an
/// edge there. Reach 0: it did not.
TouchedPart touched_part(const ProbeContacts& probe, std::uint32_t organ, const Body& body);

/// F_h/F − 1 of the force under what touches a solid there, 0 … 1: 1 is that or more. 0: there is
/// no strain.
/// @param positions  of its nodes [m]
double estimated_force_error(const OrganModel& solid, std::span<const Vec3> positions,
                             const TouchedPart& part);

}  // namespace palpate::deformation
