#include "deformation/stage.h"
#include "modules/runtime/run_stage.h"
#include "modules/runtime/worker_team.h"
#include "modules/scene/scene_reader.h"

int main(int argc, char** argv) {
  using namespace palpate;
  const runtime::ModuleProgram program{
      "deformation", "Simulates the organs of a scene in real time.", {}};
  return runtime::run_module(argc, argv, program, [](const runtime::ModuleOptions& options) {
    const scene::Scene scene = scene::load_scene(options.scene);
    // Before real-time priority is asked for: helpers must not keep others from a core.
    runtime::WorkerTeam team(scene.deformation_threads);
    auto shapes = deformation::load_organs(scene);
    runtime::run_stage(options, scene, "deformation", runtime::Priority::kPreferred,
                       [&](bus::Bus& bus) {
                         return std::make_unique<deformation::DeformationStage>(
                             scene, std::move(shapes), bus, &team);
                       });
  });
}
