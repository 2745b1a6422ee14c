// How many springs the surface of an organ asks for, known before there are any of them.
#pragma once

#include "modules/geometry/triangle_surface.h"
#include "modules/scene/scene.h"

namespace palpate::scene {

/// Costs no more than counting kMaxSprings, however many there would be: around a node with n
/// triangles bending springs join about n²/2 pairs.
/// @param surface  repaired or whole; what is too large for an organ is not counted
/// @throws InputError if there would be more than kMaxSprings springs
void check_spring_count(const geometry::TriangleSurface& surface, const Springs& springs);

}  // namespace palpate::scene
