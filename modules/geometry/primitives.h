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

TriangleSurface make_tetrahedron(double edge);  ///< regular, about the origin

}  // namespace palpate::geometry
