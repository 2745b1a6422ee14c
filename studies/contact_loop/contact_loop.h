// Does a session lose a contact? A ball goes in and out of an organ while it slides over it, and
// every search for contacts is judged by the closed surface it was made on.
#pragma once

#include <functional>

#include "palpate/session/in_process.h"

namespace palpate::contact_loop {

struct LoopCase {
  double radius = 2e-3;  ///< of the ball [m]
  double speed = 0.1;    ///< largest [m/s]
  double deformation_hz = 100;
  double collision_hz = 250;
};

/// What a run did and its searches found. A search sees the ball where it is and the surface as it
/// was up to a period ago: a ball that is faster than its radius in a period is inside that.
struct LoopResult {
  long presses = 0;   ///< in and out
  long advances = 0;  ///< of deformation
  /// Of these: the ball's centre was inside the surface they left at the pose they left it for, and
  /// outside before.
  long crossings = 0;
  long searches = 0;
  long inside = 0;           ///< the ball's centre was inside the surface
  long lost = 0;             ///< of these: no contact that pushes it out
  double longest_lost = 0;   ///< the longest such time [s]
  ContactTroubles troubles;  ///< as the session counts them
  double deepest = 0;        ///< centre below the nearest point of the surface, when inside [m]
};

/// The first organ of the scene and one ball, from the front (-y) at `place` (x, z) [m].
/// @param scene  its probes are replaced
LoopResult run_loop(const scene::Scene& scene, const session::Assets& assets, const Vec3& place,
                    const LoopCase& loop);

}  // namespace palpate::contact_loop
