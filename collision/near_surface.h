// The part of an organ's surface that comes near a probe within a step.
//
// Blocks of triangles are told apart by their boxes at the step's start and end; only in those that
// come near, nodes are looked at. What is handed out depends on each triangle alone, so it is the
// same whatever the blocks are: all triangles whose box, in the probe's frame P and over the whole
// step, comes within a reach of a box about the probe's core.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "collision/wanted_triangles.h"
#include "modules/core/sort_unique.h"

namespace palpate::collision {

class NearSurface {
 public:
  /// Where more triangles are near a round core, some stand for the others.
  static constexpr std::size_t kManyTriangles = 512;
  static constexpr int kCells = 4;  ///< along each axis of their grid

  void clear() { triangles_.clear(); }
  /// @param core   in P; may be without end
  /// @param reach  beside the chord's error (RelativeMotion::chord_error()) [m]
  void gather(const OrganStep& step, const Bounds& core, double reach);
  /// The same for a round core that is behind no wall. Where very many triangles are so near
  /// (kManyTriangles), only those that may come within its radius in the step, and of the others
  /// one at the nearest node of each cell of a grid around the core: they say where tissue is.
  /// @returns whether they are in candidates() until sweep_candidates() is called, as very many
  ///          near a ball that does not turn are
  bool gather_front(const OrganStep& step, const Core& core, double reach);
  /// A triangle that is looked at where it ends.
  struct Candidate {
    std::uint32_t triangle = 0;
    std::array<std::uint32_t, 3> corners{};  ///< in candidate_nodes()
  };
  struct EndNode {
    Vec3 end;                 ///< in P
    std::uint32_t index = 0;  ///< of the organ
  };
  /// In no order, each once.
  std::span<const Candidate> candidates() const { return candidates_; }
  std::span<const EndNode> candidate_nodes() const { return end_nodes_; }
  /// The largest way of a corner, rounded up [m].
  double candidate_travel() const { return SweptTriangle::travel_of(end_travel_squared_); }
  void sweep_candidates(const OrganStep& step);
  /// Instead of the triangles, the nodes that come so near, each once, in no useful order. Of a
  /// core without end they are far fewer than the triangles' corners.
  void gather_nodes(const OrganStep& step, const Bounds& core, double reach,
                    std::vector<std::uint32_t>& nodes);
  /// Adds triangles by their indices, each once whether it was there or not.
  void add(const OrganStep& step, std::vector<std::uint32_t>& triangles);

  /// Ascending; degenerate ones left out.
  const std::vector<SweptTriangle>& triangles() const { return triangles_; }
  /// Appends the corners of triangles() and leaves `nodes` ascending, each once.
  void append_nodes(std::vector<std::uint32_t>& nodes) const {
    for (const SweptTriangle& t : triangles_) {
      nodes.insert(nodes.end(), t.nodes.begin(), t.nodes.end());
    }
    sort_unique(nodes);
  }
  /// The largest way of a corner [m].
  double travel() const {
    double travel = 0;
    for (const SweptTriangle& t : triangles_) travel = std::max(travel, t.travel);
    return travel;
  }

 private:
  void find_blocks(const OrganStep& step, const WantedTriangles& wanted);
  template <class Turn>
  void open_blocks(const OrganStep& step, const WantedTriangles& wanted, const Turn& turn);
  void sweep();
  void sort_candidates();
  void find_apart(const OrganStep& step, std::span<const std::uint32_t> nodes,
                  const WantedTriangles& wanted);
  template <class Turn>
  void open(const OrganStep& step, std::size_t block, const WantedTriangles& wanted,
            const Turn& turn);
  bool find_places(const OrganStep& step, const Core& core, const WantedTriangles& wanted);
  template <class Turn>
  void add_places(const OrganStep& step, const WantedTriangles& there, const Turn& turn);

  std::vector<SweptTriangle> triangles_;
  // Kept between calls for their memory only.
  std::vector<std::uint32_t> blocks_;  ///< that may come near
  std::vector<Apart> apart_;           ///< by node of a block
  std::vector<std::uint32_t> place_;   ///< likewise: where in nodes_
  std::vector<SweptNode> nodes_;       ///< of triangles that may be wanted, in all opened blocks
  std::vector<EndNode> end_nodes_;     ///< likewise
  double end_travel_squared_ = 0;      ///< the largest of them [m²]
  std::vector<Candidate> candidates_, sorted_;
  std::vector<bool> seen_;  ///< by node
  NodeGrid grid_{kCells};
  std::vector<std::pair<float, std::uint32_t>> nearest_first_;  ///< blocks by distance [m²]
  std::vector<std::uint8_t> within_;                            ///< by node of a block
  std::vector<std::uint32_t> maybe_;      ///< triangles of a block that may be wanted
  std::vector<std::uint32_t> at_places_;  ///< triangles
};

}  // namespace palpate::collision
