// An organ's state carried from one mesh of halves of the same tetrahedra to another.
//
// A node of both keeps its place. A new one is the middle of two, and so are its position and
// velocity: the motion is the same piecewise linear function as before. A node that goes gives its
// mass and momentum to its two parents, in halves, which is what lumped masses do anyway: with
// φ_a⁻ = φ_a + φ_m/2 for an end of the edge that m was the middle of, m_a⁻ = m_a + m_m/2. So the
// momentum of all nodes stays what it was (what comes to a fixed node is taken by what holds it),
// an even motion stays one, and, a mean's square being no more than the mean of squares, no kinetic
// energy is gained by either way. Pressures of nodes are carried as positions are.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "deformation/model/following_mesh.h"
#include "deformation/model/organ_state.h"
#include "modules/core/simd_vectors.h"

namespace palpate::deformation {

class MeshChange {
 public:
  using Parents = geometry::HalvedMesh::Parents;

  /// @param from, to  outlive this
  /// @param from_parents, to_parents  of their nodes, see RefinedShape
  MeshChange(const Body& from, std::span<const Parents> from_parents, const Body& to,
             std::span<const Parents> to_parents);

  OrganState carried(const OrganState& state) const;
  /// How far nodes go, zero of fixed ones  (node_count of `from`, of `to`).
  std::vector<Vec4f> carried(const std::vector<Vec4f>& ways) const;

 private:
  /// Of nodes, from a piecewise linear function to the same.
  template <class Values>
  void interpolate(const Values& from, Values& to) const;

  struct Middle {
    std::uint32_t node = 0;
    Parents ends{};
  };

  const Body& from_;
  const Body& to_;
  std::vector<std::uint32_t> kept_;  ///< of each node of `to` the same one of `from`
  std::vector<Middle> going_;        ///< nodes of `from`, before their parents
  std::vector<Middle> coming_;       ///< nodes of `to`, after their parents
};

/// Holds what the coarse mesh holds and no more: a new node only where all that it comes from is
/// held. Middles of a quadratic coarse mesh's edges are nodes of it.
void hold_as_coarse(const RefinedShape& refined, Body& body);

}  // namespace palpate::deformation
