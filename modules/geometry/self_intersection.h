// Places where a surface passes through itself.
#pragma once

#include "modules/geometry/triangle_surface.h"

namespace palpate::geometry {

/// Pairs (a < b, sorted) of triangles that share more than the nodes or the edge they have in
/// common: they cross, or they lie in one plane and overlap. Double precision; triangles nearer
/// to one plane than 1e-9 of their size count as coplanar. Triangles without area are skipped.
std::vector<std::array<std::uint32_t, 2>> find_self_intersections(const TriangleSurface& surface);

/// The same for one pair.
bool triangles_intersect(std::span<const Vec3> nodes, const Triangle& first,
                         const Triangle& second);

}  // namespace palpate::geometry
