// Inside or outside of a closed surface, by brute force over all its triangles.
#pragma once

#include <span>

#include "modules/geometry/triangle_surface.h"

namespace palpate::geometry {

/// How often the surface winds around p: 1 inside, 0 outside; the sum of the triangles' solid
/// angles over 4π (Van Oosterom & Strackee 1983).
double winding_number(const Vec3& p, std::span<const Vec3> nodes,
                      std::span<const Triangle> triangles);
/// The same of nodes as they travel.
/// @param positions  x, y, z of each node [m]
double winding_number(const Vec3& p, std::span<const float> positions,
                      std::span<const Triangle> triangles);

}  // namespace palpate::geometry
