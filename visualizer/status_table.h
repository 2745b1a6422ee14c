// One line per process: state, rate, overruns, age of its newest inputs.
#pragma once

#include "visualizer/overlay.h"

namespace palpate::visualizer {

inline constexpr double kLostAfter = 2.0;  ///< a process not heard of for longer is "lost" [s]

/// The rows in order of the modules' names; a process that is not heard of any more keeps its row,
/// marked with how long it has been silent; the newest error stands below.
void add_status_table(const SceneView& view, const Box2& box, std::int64_t now_ns, Overlay& out);

}  // namespace palpate::visualizer
