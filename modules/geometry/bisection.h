// Tetrahedra halved where they are too large: conforming, and independent of history.
//
// A tetrahedron is only ever halved at its longest edge (of equal ones, the one that comes first by
// the places of its ends), so the tree of all halves is fixed by the mesh. What is returned are the
// leaves of its least conforming part that meets the sizes asked for: a tetrahedron with too long
// an edge is halved, and one that has lost an edge to a neighbour (Rivara, Int. J. Numer. Methods
// Eng. 20, 1984; Maubach, SIAM J. Sci. Comput. 16, 1995). The same sizes give the same mesh,
// whatever was asked for before.
#pragma once

#include <functional>
#include <limits>
#include <unordered_map>

#include "modules/geometry/tet_mesh.h"

namespace palpate::geometry {

/// Longest edge allowed at a place [m], above 0.
using SizeField = std::function<double(const Vec3&)>;

/// Every edge is at most as long as `size` at its middle, and each tetrahedron's longest edge at
/// most as long as `size` at its corners' mean. Nodes of `mesh` keep their numbers; the faces stay
/// where they are.
/// @param mesh  conforming, volumes positive
/// @throws InputError if it would take more than `most_nodes` nodes
TetMesh bisected(const TetMesh& mesh, const SizeField& size, std::size_t most_nodes);

/// A mesh of halves, and where it came from.
struct HalvedMesh {
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  using Parents = std::array<std::uint32_t, 2>;

  TetMesh mesh;                            ///< nodes of the coarse mesh first
  std::vector<Parents> parents;            ///< whose middle a node is, rising; kNone: coarse
  std::vector<BoundaryTriangle> boundary;  ///< as boundary_triangles()
  /// How often each tetrahedron was halved. They are in the order of the trees: what a tetrahedron
  /// of another mesh of the same halves was divided into is a run of these that has its volume.
  std::vector<std::uint8_t> halvings;
};

/// The tree of halves of one mesh, as far as it was looked at: another choice of sizes near the
/// last one costs little.
class BisectionTree {
 public:
  /// @param mesh  conforming, volumes positive
  explicit BisectionTree(TetMesh mesh);

  /// Chooses the leaves that bisected() would return.
  /// @param growth  of sizes between any two places, over their distance, at most: where tetrahedra
  ///                are much smaller than their mean's size their edges are not looked at
  /// @returns false if that would take more than `most_nodes` nodes; then none are chosen
  bool choose(const SizeField& size, double growth, std::size_t most_nodes);
  /// The mesh of the leaves chosen last; at first the coarse one.
  HalvedMesh mesh() const;
  /// Of that mesh.
  std::size_t node_count() const { return nodes_chosen_; }
  std::size_t tetrahedron_count() const { return leaves_.size(); }
  std::size_t boundary_count() const;  ///< of triangles

  const TetMesh& coarse() const { return coarse_; }

 private:
  static constexpr std::uint32_t kNone = HalvedMesh::kNone;

  struct Edge {
    std::uint32_t a = 0, b = 0;
    double squared_length = 0;
    std::uint32_t middle = kNone;  ///< its node, once the edge was halved
    std::uint32_t sized_in = 0;    ///< the last choice that looked at it
    bool too_long = false;         ///< in that
  };
  struct Node {
    Vec3 place = Vec3::Zero();
    HalvedMesh::Parents parents{kNone, kNone};
  };
  struct Tet {
    Tetrahedron corners{};
    std::array<std::uint32_t, 6> edges{};  ///< as kTetrahedronEdges
    std::uint8_t longest = 0;              ///< of those
    std::uint8_t outer = 0;                ///< bit k: the face opposite corner k is on the boundary
    std::uint8_t halvings = 0;             ///< between the coarse one and this
    std::uint32_t halves = kNone;          ///< the first of both, once made
  };

  void plant();
  void add(const Tetrahedron& corners, std::uint8_t outer, std::uint8_t halvings);
  std::uint32_t edge_between(std::uint32_t a, std::uint32_t b);
  bool comes_first(const Edge& a, const Edge& b) const;
  std::uint8_t longest_of(const Tet& tet) const;
  void halve(std::uint32_t tet);
  struct Wanted {
    const SizeField& size;
    double growth;
    std::size_t most_nodes;
  };
  bool is_too_large(const Tet& tet, const Wanted& wanted);
  bool lost_an_edge(const Tet& tet) const;
  bool append_leaves(std::uint32_t tet, bool is_small_enough, const Wanted& wanted);

  TetMesh coarse_;
  std::vector<std::uint8_t> coarse_outer_;
  std::vector<Node> nodes_;
  std::vector<Edge> edges_;
  std::vector<std::uint32_t> halved_in_;  ///< of an edge: the last choice that halves it
  std::vector<Tet> tetrahedra_;
  std::unordered_map<std::uint64_t, std::uint32_t> edge_numbers_;
  std::vector<std::uint32_t> leaves_, next_leaves_;  ///< chosen, in the tree's order
  std::uint32_t choice_ = 0;
  std::size_t nodes_chosen_ = 0;
};

}  // namespace palpate::geometry
