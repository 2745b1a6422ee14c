// Surfaces of shapes given as formulas.
#pragma once

#include <Eigen/Geometry>
#include <functional>

#include "modules/geometry/triangle_surface.h"

namespace palpate::meshes {

/// Negative inside, positive outside, about the distance to the surface near it [m].
using Shape = std::function<double(const Vec3&)>;

/// The surface shape = 0 inside `box`, outward, closed where the shape does not reach the box.
/// Marching tetrahedra: each cube of a grid of spacing `cell` [m] is cut into six tetrahedra, and
/// each tetrahedron's four values say how the surface crosses it. Doi & Koide, "An efficient
/// method of triangulating equi-valued surfaces by using tetrahedral cells", IEICE 1991.
geometry::TriangleSurface level_set_surface(const Shape& shape, const Eigen::AlignedBox3d& box,
                                            double cell);

}  // namespace palpate::meshes
