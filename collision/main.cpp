#include "collision/stage.h"
#include "modules/runtime/run_stage.h"
#include "modules/scene/scene_reader.h"

int main(int argc, char** argv) {
  using namespace palpate;
  const runtime::ModuleProgram program{
      "collision", "Finds the contacts between the probes and the organs of a scene.", {}};
  return runtime::run_module(argc, argv, program, [](const runtime::ModuleOptions& options) {
    const scene::Scene scene = scene::load_scene(options.scene);
    auto probes = collision::load_probes(scene);
    runtime::run_stage(options, scene, "collision", runtime::Priority::kPreferred,
                       [&](bus::Bus& bus) {
                         return std::make_unique<collision::CollisionStage>(scene, probes, bus);
                       });
  });
}
