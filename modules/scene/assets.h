// The meshes a scene names, loaded, checked and placed.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "modules/geometry/organ_shape.h"
#include "modules/scene/scene.h"

namespace palpate::scene {

/// Told again and again while the surface of an organ or probe is resampled.
/// @param part  that is done, 0 … 1
using Resampling = std::function<void(const std::string& owner, double part)>;

/// Shape of one organ in W [m]: load_organ_surface(), filled with tetrahedra where its model wants
/// them, or tetrahedra as they are in a file (.msh, .vtk); then the organ's pose.
/// @throws InputError naming organ, file and problem; Interrupted if a signal of StopSignal comes
geometry::OrganShape load_organ(const Organ& organ, const Resampling& resampling = {});

/// The organ's surface alone, in W [m]: nothing is filled or refined.
/// @throws InputError, Interrupted as load_organ()
geometry::TriangleSurface load_skin(const Organ& organ, const Resampling& resampling = {});

/// `mesh` with smaller tetrahedra near the regions of W.
/// @param pose  of the mesh's frame
/// @throws InputError if it would have too many nodes
geometry::TetMesh refined(const geometry::TetMesh& mesh, const Refinement& refine,
                          const Pose& pose);
/// The same of an organ, in its own frame. @throws InputError naming the key
geometry::TetMesh refined(const geometry::TetMesh& mesh, const Organ& organ);

/// Surface of a probe whose shape names a mesh, in its own frame [m]; empty for every other.
/// @throws InputError naming probe, file and problem
geometry::TriangleSurface load_probe_mesh(const Probe& probe);
/// Of all probes. @throws InputError as load_probe_mesh() does
std::vector<geometry::TriangleSurface> load_probe_meshes(const Scene& scene);

}  // namespace palpate::scene
