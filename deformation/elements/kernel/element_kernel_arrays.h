// How the element kernel sees linear tetrahedra: plain arrays, part by part of the mesh.
//
// Known to the files compiled for one instruction set each, so it must stay free of inline library
// code: the linker would keep one copy of it, possibly of an instruction set the CPU has not.
//
// A part holds some of the tetrahedra and numbers their nodes anew. What is added up over the
// tetrahedra of more than one part lies at the slots of each and is summed in the order of the
// parts, so that no thread writes where another does and no sum depends on how many there are.
//
// Pairs: the matrix is symmetric, and of each pair of neighbours (i, j) the 3×3 block is kept once,
// in the row of either. Four pairs of a row make a group, filled up with pairs to an empty node; of
// which node a pair is the row is chosen so that few are filled up. A group is four packs of
// kLanes: rows 0, 1 and 2 of its blocks, four floats each, then (elsewhere) the volume gradients.
// With every volume v a fourth of the sum over the tetrahedra around a node (the fourth is left
// out), they are
//   lane 3 of row k      ∂v_j/∂x_ik
//   the volume gradient  ∂v_i/∂x_j, 0
// Around an edge inside the mesh the second is minus the first: both are the polygon of its
// neighbours. What is left of their sum on the surface is kept apart ("open" pairs).
#pragma once

#include <cstddef>
#include <cstdint>

namespace palpate::deformation::kernel {

/// Tetrahedra side by side, and floats of a group's pack.
inline constexpr std::size_t kTetrahedronLanes = 16;
inline constexpr std::size_t kBlockFloats = 48;  ///< of a group: its blocks' rows
inline constexpr std::uint32_t kGroupPairs = 4;

/// The pair of a group `pair` / 4 in blocks: its row 0; rows 1 and 2 follow 16 and 32 further on.
inline constexpr std::size_t block_place(std::size_t pair) {
  return pair / kGroupPairs * kBlockFloats + pair % kGroupPairs * 4;
}

/// A pair with an open ring.
struct OpenPair {
  std::uint32_t row = 0, column = 0;  ///< slots, times four
  std::uint32_t pair = 0;
};

/// Adds what lies at `from`, of another part, to `to`, of this one.
struct Merge {
  std::uint32_t to = 0, from = 0;
};

/// A slot of a node that is in other parts, too, and where the node's slots are listed.
struct SharedSlot {
  std::uint32_t slot = 0, first = 0, last = 0;
};

/// Constant. Slots and pairs are counted over all parts; those of a part follow each other, its
/// last slot is the empty node.
struct ElementPart {
  std::uint32_t first_slot = 0, slot_count = 0;  ///< the empty node not counted
  std::uint32_t first_group = 0, group_count = 0;
  std::uint32_t spilt_groups = 0;  ///< behind those: pairs that other parts own
  std::uint32_t tetrahedron_count = 0;
  std::size_t first_batch = 0, batch_count = 0;
  const std::uint32_t* rows = nullptr;     ///< slots, times four  (group)
  const std::uint32_t* columns = nullptr;  ///< likewise  (group × 4)
  const OpenPair* open_pairs = nullptr;
  std::size_t first_open = 0, open_count = 0;
  const Merge* pair_merges = nullptr;  ///< pairs
  std::size_t pair_merge_count = 0;
  const Merge* node_merges = nullptr;  ///< slots
  std::size_t node_merge_count = 0;
  const std::uint32_t* owned = nullptr;  ///< slots of nodes whose first part this is
  std::size_t owned_count = 0;
  const SharedSlot* shared = nullptr;
  std::size_t shared_count = 0;
  const std::uint32_t* open_slots = nullptr;  ///< of owned nodes with open pairs
  std::size_t open_slot_count = 0;
  const std::uint32_t* nodes = nullptr;       ///< of the mesh, of all parts' slots
  const std::uint32_t* node_slots = nullptr;  ///< what shared slots list
};

/// By batches of kTetrahedronLanes, the last one of a part filled up with its last tetrahedron.
struct Tetrahedra {
  const std::uint32_t* corners = nullptr;  ///< slots, times four  (batch × 4 × lane)
  const std::uint32_t* pairs = nullptr;    ///< of the six edges  (batch × 6 × lane)
  const float* flips = nullptr;  ///< 1 where an edge's second node is the row, else 0; likewise
  const double* gradients = nullptr;  ///< ∇N of corners 1 to 3 at rest [1/m]  (batch × 9 × lane)
  const double* volumes = nullptr;    ///< at rest [m³]  (batch × lane)
};

/// What changes, by slots and pairs of all parts.
struct ElementArrays {
  double* positions = nullptr;        ///< [m], and a pressure [Pa]  (slot × 4)
  double* forces = nullptr;           ///< [N]  (slot × 4)
  double* node_volumes = nullptr;     ///< four times v [m³]  (slot)
  double* volumes = nullptr;          ///< of the tetrahedra [m³]  (batch × lane)
  float* blocks = nullptr;            ///< (group × kBlockFloats)
  float* volume_gradients = nullptr;  ///< (group × 16)
  /// Rows of the nodes' blocks, in lane 3 ∂v_i/∂x_i: of this part's tetrahedra.  (slot × 12)
  float* own_diagonals = nullptr;
  float* diagonals = nullptr;  ///< of all; 0 where another part owns the node  (slot × 12)
  /// The same with the volumes' part; to be summed over a node's slots.  (slot × 12)
  float* whole_diagonals = nullptr;
  float* open = nullptr;            ///< what open pairs' gradients sum up to  (open pair × 4)
  const float* vectors = nullptr;   ///< p of the mesh's nodes  (node × 4)
  float* products = nullptr;        ///< A p, 0 in lane 3  (node × 4)
  const float* weights = nullptr;   ///< of the nodes' volumes  (slot)
  float* p = nullptr;               ///< (slot × 4)
  float* product = nullptr;         ///< A p, and in lane 3 the change of the node's v
  float* rates = nullptr;           ///< that lane  (slot)
  float* weighted_rates = nullptr;  ///< of all parts, times the node's weight, 4 times  (slot × 4)
};

/// Tetrahedra of average_nodal_pressure.h.
struct PressureTerms {
  double shear_modulus = 0, volume_modulus = 0;  ///< μ, α [Pa]
  double scale = 0;                              ///< of K in A
};

/// Tetrahedra of corotational.h.
struct CorotationalTerms {
  double shear_modulus = 0, lambda = 0;  ///< [Pa]
  double scale = 0;
};

/// The code of one instruction set, for one part.
struct ElementFunctions {
  /// Volumes of tetrahedra, and added up over those at each node, from the positions.
  void (*take_volumes)(const ElementPart&, const Tetrahedra&, const ElementArrays&);
  /// Forces, blocks, volume gradients and own diagonals, zeroed here.
  void (*assemble_pressure)(const ElementPart&, const Tetrahedra&, const ElementArrays&,
                            const PressureTerms&);
  /// The same without volume gradients.
  void (*assemble_corotational)(const ElementPart&, const Tetrahedra&, const ElementArrays&,
                                const CorotationalTerms&);
  /// After blocks, gradients and diagonals are those of all parts: what open pairs keep, and
  /// whole diagonals.
  void (*finish_volumes)(const ElementPart&, const ElementArrays&);
  /// Σ V ψ [J] of the positions, of tetrahedra whose volumes were taken.
  double (*pressure_energy)(const ElementPart&, const Tetrahedra&, const ElementArrays&,
                            const PressureTerms&);
  double (*corotational_energy)(const ElementPart&, const Tetrahedra&, const ElementArrays&,
                                const CorotationalTerms&);
  /// Brings p, and leaves product and rates.
  void (*multiply)(const ElementPart&, const ElementArrays&);
  /// The same without rates.
  void (*multiply_blocks)(const ElementPart&, const ElementArrays&);
  /// After all parts: product += Σ (∂v) (weighted rate).
  void (*push)(const ElementPart&, const ElementArrays&);
  /// After all parts: the products of this part's nodes.
  void (*collect)(const ElementPart&, const ElementArrays&);
};

const ElementFunctions& portable_element_functions();
#if defined(__x86_64__)
const ElementFunctions& avx2_element_functions();
const ElementFunctions& avx512_element_functions();
#endif

}  // namespace palpate::deformation::kernel
