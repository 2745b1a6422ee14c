// What is constant of an organ filled with tetrahedra.
#pragma once

#include "deformation/model/organ_model.h"

namespace palpate::deformation {

/// Masses are lumped: each tetrahedron gives its corners a quarter of density × volume, a quadratic
/// one 1/36 to its corners and 4/27 to its middle nodes (the consistent diagonal, scaled:
/// E. Hinton, T. Rock, O. Zienkiewicz, Earthquake Eng. Struct. Dyn. 4, 1976). Nodes of the surface
/// and inside are fixed by the organ's regions. There are no springs.
/// @param shape  solid, in W [m]
/// @throws InputError naming the organ if every node is fixed, or Poisson's ratio or a filling does
///         not go with the model
OrganModel build_solid_model(const scene::Organ& organ, const Vec3& gravity,
                             const geometry::OrganShape& shape);

}  // namespace palpate::deformation
