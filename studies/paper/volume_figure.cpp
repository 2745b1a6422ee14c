#include <array>

#include "modules/scene/scene_reader.h"
#include "studies/paper/figures.h"
#include "studies/paper/scene_run.h"
#include "studies/report/measures.h"

namespace palpate::paper {
namespace {

constexpr double kQuickPress = 4;  // [s]: both probes have touched by then

}  // namespace

Findings make_volume_figure(const FigureOptions& options, report::Progress& progress) {
  Findings findings;
  for (const std::string organ : {"stomach", "liver"}) {
    auto scene = scene::load_scene(options.scenes / (organ + "_probe.yaml"));
    for (const std::string model : {"mass_spring", "implicit_volume"}) {
      const std::string run = organ + ", " + model_key(model);
      progress.begin("Figure 3: volume over time, " + run);
      scene.organs[0].model = model;
      const double seconds = options.quick ? kQuickPress : scene.duration;
      const auto samples = run_scene(scene, seconds, progress);
      write_samples(samples, options.out / ("figure3_" + organ + "_" + model_key(model) + ".csv"));
      findings.push_back({"Figure 3", run + ": |V-V0|/V0 largest", "",
                          report::text_of("%.2e", worst_volume_error(samples))});
      findings.push_back({"Figure 3", run + ": greatest force [N]", "",
                          report::text_of("%.3f", greatest_force(samples))});
    }
  }
  return findings;
}

}  // namespace palpate::paper
