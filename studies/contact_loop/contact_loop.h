// Does a session lose a contact? A ball, or another tool, goes in and out of an organ while it
// slides over it, and every search for contacts is judged by the closed surface it was made on.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "palpate/session/in_process.h"

namespace palpate::contact_loop {

/// What goes in and out: tip first, the tip in front.
struct Tool {
  std::string name;
  scene::ProbeShape shape;
  geometry::TriangleSurface mesh;  ///< of a MeshShape
  Quat rotation = Quat::Identity();
  double radius = 0;         ///< of a round one [m]
  double reach = 0;          ///< of the tip before the probe's origin, along +y in W [m]
  std::vector<Vec3> inside;  ///< points in P that are judged: a ball's centre, corners, … [m]
  /// Points in P that no wall may come over [m]: a round tool's core, some of a box's and a cone's
  /// inside; none of others. Corners are in a wall by what contacts give.
  std::vector<Vec3> within;

  bool is_round() const {
    return std::holds_alternative<scene::SphereShape>(shape) ||
           std::holds_alternative<scene::CapsuleShape>(shape);
  }
};
/// "ball", "needle" (1 mm thick, 40 mm long), "rod" (4 mm thick, 40 mm long, side first), "wire"
/// (the same, 1 mm thick), "box" (10 mm), "blade" (1 mm thick, edge first), "mesh" (a rough pebble
/// of 42 corners, 10 mm), "cone" (4 mm thick, 20 mm long, point first), "grasper" (jaws of 15 mm,
/// open by 0.4 rad, tips first).
/// @param radius  of the ball [m]
/// @throws InputError for another name
Tool make_tool(const std::string& name, double radius);

struct LoopCase {
  Tool tool;
  double speed = 0.1;  ///< largest [m/s]
  double deformation_hz = 100;
  double collision_hz = 250;
  double loss = 0;  ///< share of contacts and node positions that never arrive, at random
};

/// What a run did and its searches found. A search sees the tool where it is and the surface as it
/// was up to a period ago: a ball that is faster than its radius in a period is inside that.
struct LoopResult {
  long presses = 0;   ///< in and out
  long advances = 0;  ///< of deformation
  /// Of these: a point within the tool was inside the surface they left at the pose they left it
  /// for, and none before.
  long crossings = 0;
  long put_back = 0;  ///< of these: while a guard acted on the organ, and said so
  /// Advances that left tissue in a round tool whose core was outside, seen by it, deeper than
  /// before and than a step may leave it (deformation::kUnsolvedDepth), and did not say that they
  /// were not solved.
  long swallowed = 0;
  /// Of these: more of what it had begun with, or of what was said before, and was not yet out.
  long swallowed_on = 0;
  double deepest_tissue = 0;  ///< in such a tool after an advance, said or not [m]
  long searches = 0;
  long inside = 0;           ///< a point of the tool was inside the surface
  long lost = 0;             ///< of these: no contact that pushes it out
  double longest_lost = 0;   ///< the longest such time [s]
  ContactTroubles troubles;  ///< as the session counts them
  double deepest = 0;        ///< a point of the tool below the nearest of the surface [m]
};

/// The first organ of the scene and one tool, from the front (-y) at `place` (x, z) [m].
/// @param scene       its probes are replaced
/// @param keep_going  asked in each tick; may throw
LoopResult run_loop(
    const scene::Scene& scene, const session::Assets& assets, const Vec3& place,
    const LoopCase& loop, const std::function<void()>& keep_going = [] {});

}  // namespace palpate::contact_loop
