#include <CLI/CLI.hpp>

#include "visualizer/stage.h"

int main(int argc, char** argv) {
  palpate::visualizer::VisualizerOptions options;
  const auto add_options = [&](CLI::App& app) {
    app.add_flag("--headless", options.headless, "Draw without a window (needs Xvfb)");
    app.add_option("--frames", options.frames, "Folder for a PNG sequence");
    app.add_option("--frame-interval-s", options.frame_interval,
                   "Simulated seconds between two pictures of the sequence")
        ->check(CLI::Range(0.001, 3600.0))
        ->capture_default_str();
    app.add_option("--screenshot", options.screenshot, "PNG of the last picture");
  };
  return palpate::runtime::run_module(
      argc, argv,
      {"visualizer", "Shows a session: organ, probes, forces, plots and every process.",
       add_options},
      [&](const palpate::runtime::ModuleOptions& common) {
        palpate::visualizer::run_visualizer(common, options);
      });
}
