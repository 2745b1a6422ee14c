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
  /// Adds the organ's edges that are remembered.
  void append_remembered(std::uint32_t organ, std::vector<std::uint32_t>& edges) const;

  enum class Searched { kAll, kLessAhead, kPart };
  /// Where edges may come to more pairs, those that come near as the probe goes on, or what is
  /// close, are looked at; of more that they may go through in the step the others are not.
  static constexpr std::size_t kMostPairs = 262144;

  /// @param reach  where the probe may go
  /// @param edges  of the organ, ascending, each once: all that may touch in the step and all
  ///               remembered ones
  Searched find(const OrganStep& step, const SharpMesh& probe, const ProbeReach& reach,
                std::span<const std::uint32_t> edges, std::vector<FoundContact>& found);

  /// Between two steps.
  void exchange(StateArchive& archive) { archive(now_); }

 private:
  struct Crossed {
    std::uint32_t organ = 0;
    EdgePair pair;
    double depth_limit = 0;  ///< OrganStep::depth_limit of the step that crossed it
    void exchange(StateArchive& archive) { archive(organ, pair, depth_limit); }
  };
  /// One edge of the organ with all of the probe's that it may touch.
  class OrganEdge;
  /// Where an edge is looked for.
  struct Ahead {
    Vec3 way_P = Vec3::Zero();  ///< the probe's
    double beside = 0;          ///< [m]
  };
  Searched list_pairs(const OrganStep& step, const SharpMesh& probe, const ProbeReach& reach,
                      std::span<const std::uint32_t> edges);
  std::size_t list_pairs_within(const OrganStep& step, const SharpMesh& probe,
                                std::span<const std::uint32_t> edges, const Ahead& ahead);
  void list_near(const OrganEdge& edge, const SharpMesh& probe, const Ahead& ahead);
  void find_pair(const OrganEdge& edge, const SharpMesh& probe, std::uint32_t of_probe,
                 std::vector<FoundContact>& found);

  /// Of before_: those of an organ's edge.
  std::span<const Crossed> remembered(std::uint32_t organ, std::uint32_t edge) const;

  std::vector<Crossed> before_;  ///< by organ, the organ's edge and the probe's
  std::vector<Crossed> now_;
  // Kept for their memory only.
  std::vector<std::uint32_t> near_;                             ///< the probe's
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs_;  ///< the organ's edge, the probe's
};

}  // namespace palpate::collision
