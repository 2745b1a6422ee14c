// What is probably a mistake in a scene that can be run: sizes in another unit, a hand that never
// touches, nothing that holds the organ.
#pragma once

#include <string>
#include <vector>

#include "collision/approach.h"
#include "modules/geometry/triangle_surface.h"
#include "modules/scene/scene.h"

namespace palpate::launcher {

/// How a probe of the scene comes to its organs as they are at rest.
/// @param skins     of the scene's organs, in W
/// @param warnings  gets what is wrong with a recording but can be borne
/// @throws InputError as haptics::make_device() and scene::load_probe_mesh() do
collision::Approach approach_of(const scene::Scene& scene, std::size_t probe,
                                const std::vector<geometry::TriangleSurface>& skins,
                                std::vector<std::string>& warnings);

/// A line each, that says what to do.
/// @param skins  of the scene's organs, in W
/// @throws InputError for an organ or instrument of a size that none has, naming the likely unit
std::vector<std::string> doubts_about(const scene::Scene& scene,
                                      const std::vector<geometry::TriangleSurface>& skins);

/// @param owner  what messages call it  @param size  its longest side, read in mesh.unit [m]
/// @throws InputError for a size that no organ has, naming the likely unit
void check_organ_size(const std::string& owner, const scene::Mesh& mesh, double size);

/// The skins of all organs.
/// @throws InputError as scene::load_skin() does
std::vector<geometry::TriangleSurface> load_skins(const scene::Scene& scene);

}  // namespace palpate::launcher
