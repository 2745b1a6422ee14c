#include <spdlog/spdlog.h>

#include "haptics/stage.h"
#include "modules/runtime/run_stage.h"
#include "modules/scene/scene_reader.h"

int main(int argc, char** argv) {
  using namespace palpate;
  const runtime::ModuleProgram program{
      "haptics", "Reads the devices of a scene's probes and renders the force they feel.", {}};
  return runtime::run_module(argc, argv, program, [](const runtime::ModuleOptions& options) {
    const scene::Scene scene = scene::load_scene(options.scene);
    runtime::run_stage(options, scene, "haptics", runtime::Priority::kRealtime, [&](bus::Bus& bus) {
      std::vector<std::string> warnings;
      auto stage = std::make_unique<haptics::HapticsStage>(scene, bus, warnings);
      for (const auto& warning : warnings) spdlog::warn("{}", warning);
      return stage;
    });
  });
}
