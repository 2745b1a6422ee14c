// An organ's surface with as many nodes as a measurement asks for.
#pragma once

#include "modules/geometry/triangle_surface.h"

namespace palpate::bench {

/// Resampled to `nodes`; above 20,000, where resampling takes minutes, by halving the edges of a
/// fourth of the nodes as often as needed. Neighbours are near each other in memory.
geometry::TriangleSurface fine_surface(const geometry::TriangleSurface& organ, std::size_t nodes);

}  // namespace palpate::bench
