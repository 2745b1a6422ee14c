#include "palpate/recorded_scene.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "modules/core/error.h"
#include "modules/recording/sample_reader.h"
#include "modules/scene/scene_reader.h"

namespace palpate::launcher {
namespace {

constexpr std::size_t kStages = 3;

/// With the places and meshes of `from`, whose triangles are what contacts name.
scene::Organ with_surface_of(const scene::Organ& from, scene::Organ organ) {
  organ.name = from.name;
  organ.mesh = from.mesh;
  organ.pose = from.pose;
  organ.model = from.model;
  organ.solid.element_size = from.solid.element_size;
  organ.solid.refine = from.solid.refine;
  organ.process = from.process;
  return organ;
}

/// The recorded scene with all that the stages read as `scene` has it.
scene::Scene as_read_by(const std::set<std::string>& stages, const scene::Scene& scene,
                        scene::Scene recorded) {
  recorded.name = scene.name;
  recorded.duration = scene.duration;
  recorded.needs = scene.needs;
  recorded.camera = scene.camera;
  recorded.deformation_threads = scene.deformation_threads;
  recorded.rates.visualizer = scene.rates.visualizer;
  const auto anew = [&](const char* stage) { return stages.contains(stage); };
  const std::size_t probes = std::min(scene.probes.size(), recorded.probes.size());
  if (anew("haptics")) {
    recorded.haptics = scene.haptics;
    recorded.rates.haptics = scene.rates.haptics;
    for (std::size_t i = 0; i < probes; ++i) {
      recorded.probes[i].name = scene.probes[i].name;
      recorded.probes[i].device = scene.probes[i].device;
    }
  }
  if (anew("collision")) {
    recorded.rates.collision = scene.rates.collision;
    for (std::size_t i = 0; i < probes; ++i) recorded.probes[i].shape = scene.probes[i].shape;
  }
  if (!anew("deformation")) return recorded;
  recorded.rates.deformation = scene.rates.deformation;
  recorded.gravity = scene.gravity;
  recorded.contacts = scene.contacts;
  for (std::size_t i = 0; i < probes; ++i) recorded.probes[i].friction = scene.probes[i].friction;
  if (anew("collision")) {
    recorded.organs = scene.organs;
  } else {
    const std::size_t organs = std::min(scene.organs.size(), recorded.organs.size());
    for (std::size_t k = 0; k < organs; ++k) {
      recorded.organs[k] = with_surface_of(recorded.organs[k], scene.organs[k]);
    }
  }
  return recorded;
}

}  // namespace

std::optional<SceneDescription> scene_told_in(const std::filesystem::path& recording) {
  recording::SampleReader reader(recording);
  while (const auto sample = reader.next()) {
    messages::AnyMessage message;
    if (sample->topic->name != bus::kScene.name) continue;
    if (sample->topic->type->decode(sample->payload, message) != nullptr) continue;
    if (const auto* scene = std::get_if<SceneDescription>(&message)) return *scene;
  }
  return {};
}

SceneDescription recorded_scene(const std::filesystem::path& recording) {
  if (auto told = scene_told_in(recording)) return *told;
  throw InputError(recording.string() + ": holds no scene: it began after the session or is torn");
}

void check_scene_of_rerun(const std::filesystem::path& recording, const SceneDescription& recorded,
                          const scene::Scene& scene, const std::set<std::string>& stages,
                          bool other_hand) {
  const std::string digest = scene::scene_digest(scene);
  if (digest == recorded.digest || stages.size() == kStages) return;
  const scene::Scene then = scene::parse_scene(recorded.resolved_text, recording);
  auto read = stages;
  if (other_hand) read.insert("haptics");
  if (scene::scene_digest(as_read_by(read, scene, then)) == digest) return;
  throw InputError(fmt::format(
      "{}: is of scene '{}', from which '{}' differs in what other stages than {} read; compute "
      "these anew, too, or leave it",
      recording.string(), recorded.name, scene.name, fmt::join(stages, ", ")));
}

}  // namespace palpate::launcher
