// The mesh that the reference solution of a solid is found on.
#pragma once

#include "modules/geometry/organ_shape.h"
#include "modules/scene/scene.h"

namespace palpate::plan {

/// Edges of the reference's triangles where probes come near, in radii of the probe.
inline constexpr double kReferenceEdge = 0.25;

/// The scene's own surface, filled with linear tetrahedra, with edges of `edge` radii of a probe
/// where probes come near in the first `duration` [s]: a probe that is small beside the triangles
/// would meet a surface several times too hard, whatever the elements.
/// @param scene  one organ, a solid @throws InputError as scene::load_organ, or if gmsh is missing
geometry::OrganShape solid_reference_shape(const scene::Scene& scene, double duration, double edge);

}  // namespace palpate::plan
