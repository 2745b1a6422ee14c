// What the searches need of a probe's form.
#pragma once

#include <memory>
#include <optional>

#include "collision/core_sweep.h"
#include "collision/mesh_solid.h"
#include "collision/probe_solid.h"

namespace palpate::collision {

struct ProbeModel {
  explicit ProbeModel(geometry::ProbeForm form);

  /// A core; of a sharp probe a corner or a line within, as a core.
  Core core(std::uint32_t index) const;

  std::vector<Core> cores;            ///< ball; rounded segment: it and both its ends
  std::unique_ptr<SharpMesh> sharp;   ///< box, surface: corners and edges
  std::vector<Core> lines;            ///< of those: within, numbered on from the corners
  std::unique_ptr<ProbeSolid> solid;  ///< all that are not round
  bool is_bounded = true;             ///< all but the half-space
  bool is_round = false;              ///< a ball about P's origin: rotation changes nothing
  Bounds hull;                        ///< all of it is within `hull_radius` of this box in P [m]
  double hull_radius = 0;             ///< [m]
  double reach = 0;                   ///< largest distance of the surface from P's origin [m]
  double max_tracked_penetration =
      0;  ///< twice the largest half extent; the half-space's is unlimited
};

}  // namespace palpate::collision
