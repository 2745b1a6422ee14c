// What the explicit methods beside the implicit constraint share: the parts of a step that are not
// their own.
#pragma once

#include <vector>

#include "deformation/model/organ_model.h"
#include "deformation/volume/volume_constraint.h"

namespace palpate::deformation {

/// Of a bound, as for the implicit constraint.
inline constexpr double kExplicitStepSafety = 0.9;

/// Largest step [s] of symplectic Euler for the organ's springs and damping together with forces
/// of the method's own, a safety factor of 0.9 included. By the triangle inequality of the matrix
/// norm the squared frequencies add up at most: ω² ≤ ω²_springs + added.
/// @param added_squared_frequency  bound of those forces' highest eigenvalue of M⁻¹K [rad²/s²]
double largest_explicit_step(const OrganModel& model, double added_squared_frequency);

/// out_i += scale M⁻¹ g_i over the surface nodes; fixed nodes keep what they have.
void add_along_gradient(const Body& body, const std::vector<Vec3>& gradient, double scale,
                        std::vector<Vec3>& out);

/// gᵀM⁻¹g is too small for a multiplier to change the volume.
bool has_vanished(const Body& body, const VolumeGradient& volume);

}  // namespace palpate::deformation
