// Contacts of a probe's sharp edges with an organ's edges, so that an edge lying between nodes is
// not missed.
//
// In front: the closest points lie inside both edges, the direction between them is one in which
// both edges are really the nearest feature of their solids (not one of their faces), and the
// organ's edge faces the probe. Behind: continuous detection found the edges passing through each
// other from the front (now or earlier, remembered); then the normal is their common perpendicular
// on the organ's outer side.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "collision/contact_reduction.h"
#include "collision/mesh_solid.h"
#include "collision/surface_change.h"
#include "modules/core/state_archive.h"

namespace palpate::collision {

using EdgePair = std::pair<std::uint32_t, std::uint32_t>;  ///< probe's edge, organ's edge

class EdgeContacts {
 public:
  void reset();
  /// What is remembered of an organ is found again on other triangles.
  void change_surface(const SurfaceChange& change);
  void begin_step();
  void append_remembered(std::uint32_t organ, std::vector<EdgePair>& pairs) const;

  /// @param pairs  each once: all that may touch in the step and all remembered ones
  void find(const OrganStep& step, const SharpMesh& probe, std::span<const EdgePair> pairs,
            std::vector<FoundContact>& found);

  /// Between two steps.
  void exchange(StateArchive& archive) { archive(now_); }

 private:
  struct Crossed {
    std::uint32_t organ = 0;
    EdgePair pair;
    double depth_limit = 0;  ///< OrganStep::depth_limit of the step that crossed it
    void exchange(StateArchive& archive) { archive(organ, pair, depth_limit); }
  };
  void find_pair(const OrganStep& step, const SharpMesh& probe, const EdgePair& pair,
                 std::vector<FoundContact>& found);

  const Crossed* remembered(std::uint32_t organ, const EdgePair& pair) const;

  std::vector<Crossed> before_, now_;
};

}  // namespace palpate::collision
