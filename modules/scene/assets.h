// The meshes a scene names, loaded, checked and placed.
#pragma once

#include <vector>

#include "modules/geometry/triangle_surface.h"
#include "modules/scene/scene.h"

namespace palpate::scene {

/// Surface of one organ in W [m]: load_organ_surface(), then the organ's pose.
/// @throws InputError naming organ, file and problem
geometry::TriangleSurface load_organ(const Organ& organ);

/// Surface of a MeshShape probe in its own frame [m]; empty for every other shape.
/// @throws InputError naming probe, file and problem
geometry::TriangleSurface load_probe_mesh(const Probe& probe);

}  // namespace palpate::scene
