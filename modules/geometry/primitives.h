// Surfaces of simple solids, closed and oriented outward.
#pragma once

#include "modules/geometry/triangle_surface.h"

namespace palpate::geometry {

/// Subdivided icosahedron on the sphere: 10·4ⁿ + 2 nodes. @param levels n, 0 … 7
TriangleSurface make_ball(double radius, int levels);

/// Axis-aligned box about the origin with `divisions` ≥ 1 squares per side.
TriangleSurface make_box(const Vec3& size, int divisions = 1);

/// Capsule about the origin along z; `length` is between the centres of the end spheres.
TriangleSurface make_capsule(double radius, double length, int segments = 24);

/// Cone with its point at the origin and its axis along +z, as a pyramid inscribed in it: flats are
/// radius × (1 − cos(π / sides)) inside the smooth one at most.
/// @param radius  of the base, at z = `length`. @param sides  ≥ 3
TriangleSurface make_cone(double radius, double length, int sides = 32);

/// Two straight jaws that open from a hinge, symmetric about the plane y = 0 and along x: the
/// middle between their tips' inner edges is the origin, the hinge is above it, at +z.
/// @param length     of a jaw's inner face. @param width  along x
/// @param thickness  of a jaw. @param opening  between the inner faces, in (0, π/2) [rad]
TriangleSurface make_jaws(double length, double width, double thickness, double opening);

TriangleSurface make_tetrahedron(double edge);  ///< regular, about the origin

}  // namespace palpate::geometry
