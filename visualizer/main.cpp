#include "visualizer/stage.h"

int main(int argc, char** argv) {
  palpate::visualizer::VisualizerOptions options;
  const auto add_options = [&](palpate::runtime::Options& added) {
    added.flag("--headless", options.headless, "Draw without a window (needs Xvfb)");
    added.flag("--ends-run", options.ends_run, "q ends the session, not the window alone");
    added.flag("--stays", options.stays, "The window stays when a lockstep has ended, until q");
    added.add("--frames", options.frames, "Folder for a PNG sequence");
    added
        .add("--frame-interval-s", options.frame_interval,
             "Simulated seconds between two pictures of the sequence")
        .range(0.001, 3600.0)
        .shows_default();
    added.add_output("--screenshot", options.screenshot, "PNG of the last picture");
  };
  return palpate::runtime::run_module(
      argc, argv,
      {"visualizer", "Shows a session: organ, probes, forces, plots and every process.",
       add_options},
      [&](const palpate::runtime::ModuleOptions& common) {
        palpate::visualizer::run_visualizer(common, options);
      });
}
