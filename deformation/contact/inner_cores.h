// What a sharp tool has inside, so that a step can be looked at for a wall that went through it.
#pragma once

#include <vector>

#include "modules/geometry/probe_form.h"
#include "modules/scene/probe_shape.h"

namespace palpate::deformation {

/// Thin capsules within the tool, close to its surface: of a cone its axis from near the tip on, of
/// a box its edges and the middle lines of its faces, of graspers and meshes lines between places
/// near nodes that are far from each other. None of round tools and planes. In P [m].
/// @param mesh  of a MeshShape; empty: none of it
std::vector<geometry::RoundedSegment> inner_cores(const scene::ProbeShape& shape,
                                                  const geometry::TriangleSurface& mesh = {});

}  // namespace palpate::deformation
