// What the searches need of a probe's shape.
#pragma once

#include <memory>
#include <optional>

#include "collision/contact_finder.h"
#include "collision/core_sweep.h"
#include "collision/mesh_solid.h"
#include "collision/probe_solid.h"

namespace palpate::collision {

struct ProbeModel {
  explicit ProbeModel(ProbeGeometry probe);

  std::vector<Core> cores;            ///< sphere; capsule: its axis and both ends
  std::unique_ptr<SharpMesh> sharp;   ///< box, mesh: corners and edges
  std::unique_ptr<ProbeSolid> solid;  ///< box, plane, mesh
  bool is_bounded = true;             ///< all but the plane
  bool is_round = false;              ///< sphere: rotation changes nothing
  Bounds bounds;                      ///< in P [m], if bounded
  double reach = 0;                   ///< largest distance of the surface from P's origin [m]
  double depth_believed = 0;          ///< twice the largest half extent; the plane's is unlimited
};

}  // namespace palpate::collision
