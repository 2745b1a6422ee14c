// Removal of triangles without area that keeps a closed surface closed.
#pragma once

#include "modules/geometry/triangle_surface.h"

namespace palpate::geometry {

/// A triangle (a, m, b) whose node m lies on its edge a–b is replaced, together with the triangle
/// (…a, b, d) across that edge, by (a, m, d) and (m, b, d): the same shape without the sliver.
/// Left alone where the edge is not shared by exactly two triangles or m–d is an edge already.
/// @return number of slivers removed
std::size_t flip_slivers(TriangleSurface& surface);

}  // namespace palpate::geometry
