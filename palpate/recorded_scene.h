// The scene of a recording, beside the one it is to be computed anew with.
#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>

#include "modules/messages/messages.h"
#include "modules/scene/scene.h"

namespace palpate::launcher {

/// The scene that was told first; none where the recording began after the session or is torn.
/// @throws InputError as SampleReader does
std::optional<SceneDescription> scene_told_in(const std::filesystem::path& recording);

/// The same.
/// @throws InputError as SampleReader does, and if there is none
SceneDescription recorded_scene(const std::filesystem::path& recording);

/// What stages that are not computed anew said is of the recorded scene: of it `scene` may differ
/// only in what the others read. Organs that are not where, or meshed as, they were recorded need
/// collision and deformation both.
/// @param stages      haptics, collision, deformation
/// @param other_hand  `scene` may have another device and other limits, which are not used without
///                    haptics: it is a scene of its own, which is tried on the recorded hand
/// @throws InputError naming the recording
void check_scene_of_rerun(const std::filesystem::path& recording, const SceneDescription& recorded,
                          const scene::Scene& scene, const std::set<std::string>& stages,
                          bool other_hand);

}  // namespace palpate::launcher
