// The visualizer as a process: topics in, pictures out; a dragged probe and session commands back.
#pragma once

#include <filesystem>

#include "modules/runtime/module_options.h"

namespace palpate::visualizer {

struct VisualizerOptions {
  bool ends_run = false;             ///< --ends-run: q stops the session, too
  bool stays = false;                ///< --stays: a window, when a lockstep has ended
  bool headless = false;             ///< --headless; also taken where there is no display
  std::filesystem::path frames;      ///< --frames DIR: PNG sequence; empty = none
  double frame_interval = 1;         ///< --frame-interval-s, simulated [0.001 … 3600]
  std::filesystem::path screenshot;  ///< --screenshot FILE: the last picture; empty = none
};

/// Shows the session until it stops, a signal comes or the window is closed. Nothing that other
/// processes do or fail to do ends it.
/// @throws InputError for a scene or folder that cannot be used; std::runtime_error without any
///         display (names what to install), or if a picture cannot be written
void run_visualizer(const runtime::ModuleOptions& common, const VisualizerOptions& options);

}  // namespace palpate::visualizer
