// What is probably a mistake in a scene that can be run: sizes in another unit, a hand that never
// touches, nothing that holds the organ.
#pragma once

#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "collision/approach.h"
#include "modules/geometry/triangle_surface.h"
#include "modules/scene/assets.h"
#include "modules/scene/scene.h"
#include "modules/trajectories/motion_facts.h"
#include "modules/trajectories/progress.h"

namespace palpate::launcher {

/// What can be said of a probe's motion before a run.
struct ProbeMotion {
  collision::Approach approach;                        ///< to organs as they are at rest
  std::optional<trajectories::MotionFacts> recording;  ///< of a recorded one, all of it
};

/// @param skins     of the scene's organs, in W
/// @param warnings  gets what is wrong with a recording but can be borne
/// @param progress  told while a long recording is read
/// @throws InputError as haptics::make_device() and scene::load_probe_mesh() do
ProbeMotion motion_of(const scene::Scene& scene, std::size_t probe,
                      const std::vector<geometry::TriangleSurface>& skins,
                      std::vector<std::string>& warnings,
                      const trajectories::Progress& progress = {});

struct SceneDoubts {
  std::vector<std::string> lines;    ///< each says what to do
  std::vector<ProbeMotion> motions;  ///< of each probe
};

/// @param skins  of the scene's organs, in W
/// @throws InputError for an organ or instrument of a size that none has, naming the likely unit
SceneDoubts doubts_about(const scene::Scene& scene,
                         const std::vector<geometry::TriangleSurface>& skins,
                         const trajectories::Progress& progress = {});

/// Prints how far a long recording is read, at most every two seconds. Throws Interrupted if a
/// signal of StopSignal comes.
trajectories::Progress progress_on(std::ostream& log);

/// Prints that something is resampled, and how far that is: after a second, then every two.
scene::Resampling resampling_on(std::ostream& log);

/// Where a mesh's unit is said, for messages: in a scene, or by --unit of a command.
enum class UnitIs { kKey, kOption };

/// @param owner  what messages call it  @param size  its longest side, read in mesh.unit [m]
/// @throws InputError for a size that no organ has, naming the likely unit
void check_organ_size(const std::string& owner, const scene::Mesh& mesh, double size,
                      UnitIs said = UnitIs::kKey);

/// "OWNER moves over 120 m: are its positions in millimetres?", where a hand would not; else empty.
/// @param extent  [m]
std::string doubt_about_extent(const std::string& owner, double extent);

/// The skins of all organs.
/// @throws InputError, Interrupted as scene::load_skin() does
std::vector<geometry::TriangleSurface> load_skins(const scene::Scene& scene,
                                                  const scene::Resampling& resampling = {});

}  // namespace palpate::launcher
