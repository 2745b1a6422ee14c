// Some nodes of a body, for what is local to them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "deformation/model/body.h"

namespace palpate::deformation {

struct Patch {
  std::vector<std::uint32_t> nodes;  ///< free ones
  std::vector<std::int32_t>
      places;  ///< where a node stands in `nodes`, −1: not among them  (node_count)

  int place(std::uint32_t node) const { return places[node]; }
};

/// Of the nodes that go along with a touch, no more than this are looked at one by one.
inline constexpr std::size_t kMostInReach = 400;

/// Neighbours in a body: nodes that share an edge of its triangles or tetrahedra.
class Neighbours {
 public:
  /// @param tetrahedra  their corners; empty for a surface
  Neighbours(const Body& body, std::span<const std::array<std::uint32_t, 4>> tetrahedra);

  std::span<const std::uint32_t> of(std::uint32_t node) const {
    return {neighbours_.data() + starts_[node], starts_[node + 1] - starts_[node]};
  }

 private:
  std::vector<std::uint32_t> starts_, neighbours_;
};

/// Fills the patch with the free ones of `touched` and, ring by ring, of their neighbours, at most
/// `most` in all. A ring stands from the nearest to `centre` [m] to the furthest, so that a smaller
/// patch about the same nodes is the beginning of a larger one.
void grow_patch(const Body& body, const Neighbours& neighbours, const std::vector<Vec3>& positions,
                std::span<const std::uint32_t> touched, const Vec3& centre, std::size_t most,
                Patch& patch);

/// How many edges of a surface away from what is moved within a step something goes along: twice
/// the length over which the motion falls to 1/e.
/// @param stiffness  what a node's springs resist with, over what its mass does
double edges_in_reach(double stiffness);

/// How many nodes of a surface lie so many edges about some that are moved, and these.
std::size_t nodes_in_reach(std::size_t touched, double edges);

}  // namespace palpate::deformation
