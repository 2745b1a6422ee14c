// One organ: a body of springs or a body of tetrahedra.
#pragma once

#include <variant>

#include "deformation/model/body.h"
#include "deformation/model/spring_network.h"
#include "deformation/model/tet_mesh.h"
#include "modules/geometry/organ_shape.h"

namespace palpate::deformation {

/// Constant after construction.
struct OrganModel : Body {
  std::variant<SpringNetwork, TetMesh> material;

  bool is_solid() const { return std::holds_alternative<TetMesh>(material); }
  /// Of an organ of springs; there is none of a solid.
  const SpringNetwork& network() const { return std::get<SpringNetwork>(material); }
  SpringNetwork& network() { return std::get<SpringNetwork>(material); }
  /// Of a solid; there is none of an organ of springs.
  const TetMesh& mesh() const { return std::get<TetMesh>(material); }
  TetMesh& mesh() { return std::get<TetMesh>(material); }
};

/// A surface becomes springs (build_spring_organ), a solid tetrahedra (build_solid).
/// @param rest_shape  closed, oriented outward, in W [m]
/// @throws InputError naming the organ if every node is fixed, the volume is not positive, or a
///         setting does not go with the model
OrganModel build_organ_model(const scene::Organ& organ, const Vec3& gravity,
                             const geometry::OrganShape& rest_shape);

/// The organ's total mass is density × enclosed volume (filled organ), spread over the surface
/// nodes by area. A tenth as much goes to the virtual nodes by their springs' stiffness (contents
/// that move with the axis), and at least so much that none has more stiffness per mass than the
/// mean surface node; the sum is scaled back to the total. So virtual nodes never limit the step.
/// Spring damping is ζ of the spring's own critical damping, c = 2 ζ √(k m_a m_b/(m_a+m_b)); edge
/// and bending springs take the mean surface node for both ends, so that the springs of a family
/// differ in length only (spring_kernel.h).
OrganModel build_spring_organ(const scene::Organ& organ, const Vec3& gravity,
                              const geometry::TriangleSurface& rest_surface);

/// Masses are lumped: each tetrahedron gives its corners a quarter of density × volume, a quadratic
/// one 1/36 to its corners and 4/27 to its middle nodes (the consistent diagonal, scaled:
/// E. Hinton, T. Rock, O. Zienkiewicz, Earthquake Eng. Struct. Dyn. 4, 1976). Nodes of the surface
/// and inside are fixed by the organ's regions.
OrganModel build_solid(const scene::Organ& organ, const Vec3& gravity,
                       const geometry::OrganShape& rest_shape);

/// Largest step [s] for which symplectic Euler with damping evaluated at the old velocity is
/// stable, of an organ of springs. Each mode ẍ + d ẋ + ω² x = 0 needs 4 − 2 h d − h² ω² > 0, that
/// is h < (2/ω)(√(1+ζ²) − ζ) with ζ = d/2ω; ω and d are taken from Gershgorin's bounds.
double stable_step_bound(const OrganModel& model);

}  // namespace palpate::deformation
