// How the parts of element_parts.h are made.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "deformation/elements/kernel/element_parts.h"

namespace palpate::deformation {

class ElementPartsBuilder {
 public:
  ElementPartsBuilder(const LinearTetrahedra& mesh, ElementParts& parts)
      : mesh_(mesh), out_(parts) {}

  void build();

 private:
  static constexpr std::uint32_t kNone = ~0u;

  /// Two neighbours within a part, by its own numbers of nodes.
  struct Edge {
    std::uint32_t low = 0, high = 0;
    std::uint64_t ring = 0;  ///< 0 if the tetrahedra around it close, but by rarest chance
    /// Of an edge that another part owns: that part and its edge there.
    std::uint32_t owning_part = kNone, owning_edge = kNone;
    bool row_is_high = false;
    std::uint32_t pair = kNone;  ///< place, over all parts
  };
  struct Placed {
    Vec3 centre = Vec3::Zero();
    std::uint32_t tetrahedron = 0;
  };
  /// Where an edge of a part is remembered by its nodes.
  struct Remembered {
    std::uint32_t nodes = 0;  ///< both numbers: a part has fewer than 65,536
    std::uint32_t edge = kNone;
  };
  struct Part {
    std::size_t first = 0, last = 0;   ///< of order_
    std::vector<std::uint32_t> nodes;  ///< of the mesh
    std::vector<Edge> edges;
    std::vector<std::array<std::uint32_t, 6>> edges_of;  ///< of its tetrahedra
    std::vector<std::array<std::uint32_t, 4>> corners;
  };
  /// Edges in the row of a node.
  struct Group {
    std::uint32_t row = 0;
    std::array<std::uint32_t, kernel::kGroupPairs> edges{kNone, kNone, kNone, kNone};
  };
  /// An edge that may be in more than one part.
  struct Meeting {
    std::uint64_t key = 0;
    std::uint32_t part = 0, edge = 0;
    auto operator<=>(const Meeting&) const = default;
  };

  void halve(std::size_t first, std::size_t last);
  std::size_t cut(std::size_t first, std::size_t last);
  void number_nodes(Part& part);
  void find_edges(Part& part);
  std::uint32_t edge_between(Part& part, std::uint32_t a, std::uint32_t b);
  void take_slots();
  void find_owners();
  std::vector<Group> groups_of(const Part& part) const;
  void place_rows(std::size_t index);
  void place_spilt(std::size_t index);
  void take_open_pairs(std::size_t index);
  void take_merges(std::size_t index);
  void take_tetrahedra(std::size_t index);
  void point_parts();

  const LinearTetrahedra& mesh_;
  ElementParts& out_;
  std::vector<Placed> order_;             ///< of the tetrahedra
  std::vector<std::uint64_t> scrambled_;  ///< numbers of the mesh's nodes
  std::vector<Remembered> remembered_;    ///< a part's edges, while they are found
  int remembered_bits_ = 0;               ///< of a place there
  std::vector<Part> parts_;
  std::vector<std::uint32_t> numbers_;  ///< of the mesh's nodes within a part, else kNone
  std::vector<bool> is_open_;           ///< nodes with open pairs
  std::vector<std::size_t> first_columns_, first_rows_, first_pair_merges_, first_node_merges_,
      first_owned_, first_shared_, first_open_slots_;
};

}  // namespace palpate::deformation
