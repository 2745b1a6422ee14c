// The visible surface of a probe.
#pragma once

#include "modules/geometry/triangle_surface.h"
#include "modules/scene/scene.h"

namespace palpate::visualizer {

/// Surface in the probe's own frame [m]. A plane has no end: it becomes a square patch of
/// `patch_size` about the origin.
/// @param mesh  surface of a MeshShape probe, see scene::load_probe_mesh(); else not used
geometry::TriangleSurface probe_surface(const scene::ProbeShape& shape, double patch_size,
                                        const geometry::TriangleSurface& mesh);

/// Largest distance of the surface's nodes from the probe's origin, for picking [m].
double reach(const geometry::TriangleSurface& surface);

}  // namespace palpate::visualizer
