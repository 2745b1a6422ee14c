// What a sharp tool has inside, so that a step can be looked at for a wall that went through it.
#pragma once

#include <vector>

#include "modules/geometry/probe_form.h"
#include "modules/scene/probe_shape.h"

namespace palpate::deformation {

/// Thin capsules within the tool, close to its surface: of a cone its axis from near the tip on, of
/// a box its edges and the middle lines of its faces. None of round tools, planes, graspers and
/// meshes. In P [m].
std::vector<geometry::RoundedSegment> inner_cores(const scene::ProbeShape& shape);

}  // namespace palpate::deformation
