// The last word on a step: no two surfaces pass through each other.
//
// Pairs of features that would meet on their way become zones, which move as one: by the mean of
// their nodes' ways, weighted by mass, so that momentum is kept and energy falls; a zone with a
// fixed node stays. Zones that would meet others grow. Where that comes to no end, all stay where
// they were, which is always allowed. After the rigid impact zones of X. Provot, "Collision and
// Self-Collision Handling in Cloth Model Dedicated to Design Garments", 1997; R. Bridson,
// R. Fedkiw, J. Anderson, "Robust Treatment of Collisions, Contact and Friction for Cloth
// Animation", 2002.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "collision/near_features.h"
#include "deformation/model/body.h"

namespace palpate::deformation {

/// Surfaces stay further apart than this, or than they were [m].
inline constexpr double kLeastDistance = 1e-6;

/// A pair that may meet within a step.
struct StepPair {
  collision::FeaturePair pair;
  collision::FourPoints start;       ///< [m]
  collision::Separation separation;  ///< there
};

struct MovingSurface {
  const Body* body = nullptr;
  std::span<const Vec3> searched;  ///< where pairs were looked for [m]  (surface_node_count)
  std::span<const Vec3> start;     ///< [m]  (surface_node_count)
  std::span<Vec3> end;             ///< is shortened [m]  (at least surface_node_count)
  Vec3 together = Vec3::Zero();    ///< how far all surfaces have come since then [m]
  /// Pairs are complete while no node is further from where it was then and came so far [m].
  double travel = 0;
};

enum class Confinement : std::uint8_t {
  kNone,       ///< nothing would have met
  kZones,      ///< some nodes were made to move as one
  kHeld,       ///< no surface moved
  kIncomplete  ///< a node went beyond `travel`: the ends mean nothing
};

/// How far the farthest node is from `origins`, moved by `together` [m]; infinite where one is no
/// number.
double farthest_travel(std::span<const Vec3> origins, std::span<const Vec3> positions,
                       const Vec3& together = Vec3::Zero());

/// @param pairs  all that may meet while every surface keeps to its `travel`
Confinement confine_motion(std::span<const StepPair> pairs,
                           std::span<const MovingSurface> surfaces);

}  // namespace palpate::deformation
