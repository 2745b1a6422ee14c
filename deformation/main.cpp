#include "deformation/stage.h"
#include "modules/core/error.h"
#include "modules/runtime/run_stage.h"
#include "modules/runtime/wiring.h"
#include "modules/runtime/worker_team.h"
#include "modules/scene/assets.h"
#include "modules/scene/key_place.h"
#include "modules/scene/processes.h"
#include "modules/scene/scene_reader.h"

int main(int argc, char** argv) {
  using namespace palpate;
  std::size_t process = 1;
  const runtime::ModuleProgram program{
      "deformation", "Simulates the organs of a scene in real time.", [&](runtime::Options& more) {
        more.add("--process", process, "Whose organs: key 'process' of the scene's organs")
            .range(1, scene::kMaxProcesses)
            .shows_default();
      }};
  return runtime::run_module(argc, argv, program, [&](const runtime::ModuleOptions& options) {
    const scene::Scene scene = scene::load_scene(options.scene);
    const std::size_t processes = scene::process_count(scene);
    if (process > processes) {
      throw InputError("--process " + std::to_string(process) + ": the scene has " +
                       std::to_string(processes) + " of deformation");
    }
    // Before real-time priority is asked for: helpers must not keep others from a core.
    runtime::WorkerTeam team(scene.deformation_threads);
    std::vector<geometry::OrganShape> shapes;
    for (const std::size_t organ : scene::organs_of(scene, process)) {
      shapes.push_back(scene::with_organ(scene, organ,
                                         [](const auto& each) { return scene::load_organ(each); }));
    }
    const auto meshes = scene::load_probe_meshes(scene);
    runtime::run_stage(options, scene, runtime::name_of({"deformation", process}),
                       runtime::Priority::kPreferred, [&](bus::Bus& bus) {
                         auto stage = std::make_unique<deformation::DeformationStage>(
                             scene, std::move(shapes), bus, process, &team,
                             deformation::Guarding::kOn, meshes);
                         // Last: threads that are started later would keep to that core, too.
                         if (options.lockstep.empty()) team.keep_to_own_cores();
                         return stage;
                       });
  });
}
