// How the spring kernel sees an organ: plain arrays in sliced ELLPACK order.
//
// Known to the files compiled for one instruction set each, so it must stay free of inline library
// code: the linker would keep one copy of it, possibly of an instruction set the CPU has not.
//
// Springs: surface nodes, in their order, form slices of kLanes rows. A row holds its node's
// neighbours, the structural ones, then the bending ones. Slot s of a slice holds the s-th
// neighbour of all its rows side by side. Shorter rows are filled up with the node itself: a spring
// without length pulls at nothing. The inner spring of a node is in arrays of its own.
//
// Where the volume is kept, structural neighbours stand in the order of the one-ring
// (counter-clockwise from outside).
//
// Fans: runs of triangles around a node, the node itself in the first slot, then the run's nodes in
// order, the first again where it closes. Eight stand side by side; shorter ones repeat their last
// node, which adds triangles without area.
//
// Monakov, Lokhmotov & Avetisyan, "Automatically tuning sparse matrix-vector multiplication for GPU
// architectures", HiPEAC 2010 (sliced ELLPACK).
#pragma once

#include <cstddef>
#include <cstdint>

namespace palpate::deformation::kernel {

/// Rows of a slice, floats in the widest register. The same for every instruction set, so that all
/// sum in the same order.
inline constexpr std::size_t kLanes = 16;
inline constexpr std::size_t kDoubleLanes = 8;  ///< the same for doubles

/// A packed node: x y z 0 relative to an origin [m], then another vector, x y z 0.
inline constexpr std::size_t kNodeFloats = 8;

/// Added to l² [m²]: far below the rounding of any spring, and the force of one without length is
/// zero, not NaN.
inline constexpr float kTinySquare = 1e-30f;

/// l₀ of filled-up springs [m]: no energy worth the name, and never under tension.
inline constexpr float kPaddingLength = 1e-12f;

struct Slice {
  std::size_t first_slot = 0;
  std::uint32_t structural_slots = 0;
  std::uint32_t slots = 0;                       ///< structural and bending slots
  std::uint32_t shortest_ring = 0;               ///< structural slots no row fills up
  std::uint32_t first_link = 0, link_count = 0;  ///< virtual nodes its inner springs go to
};

/// A virtual node some rows of a slice hang on.
struct Link {
  std::uint32_t virtual_node = 0;
  float weights[kLanes] = {};  ///< 1 for its rows, 0 for others
};

/// Fans side by side.
struct Fans {
  std::uint32_t first_slot = 0;
  std::uint32_t slots = 0;  ///< the center included; even
};

struct FanTable {
  const Fans* fans = nullptr;
  const std::uint32_t* nodes = nullptr;  ///< first coordinates  (slots × kDoubleLanes)
};

/// Constant per organ. Rows are padded to a multiple of kLanes: row_count = kLanes · slice_count.
struct Layout {
  std::size_t surface_node_count = 0, virtual_node_count = 0, slice_count = 0;
  std::size_t slices_per_chunk = 0, chunk_count = 0;
  const Slice* slices = nullptr;              ///< (slice_count)
  const std::uint32_t* neighbours = nullptr;  ///< first floats of packed nodes  (slots × kLanes)
  const float* rest_lengths = nullptr;        ///< l₀ [m]  (slots × kLanes)
  const std::uint32_t* row_nodes = nullptr;   ///< first float; the last node again in padding
  FanTable rings;                             ///< the fan of each row, closed
  FanTable cover;                             ///< fans that hold each triangle once
  const std::uint32_t* first_fans = nullptr;  ///< each chunk's, and the end  (chunk_count + 1)
  const double* inverse_masses = nullptr;     ///< each node's three times [1/kg], 0 in padding
  // Springs of one family are alike but for their lengths. Damping as a time τ = c/k [s].
  float structural_stiffness = 0, bending_stiffness = 0;        ///< k [N/m]
  float structural_damping_time = 0, bending_damping_time = 0;  ///< τ [s]
  // Inner springs, one per row; 0 stiffness in padding, all absent without virtual nodes.
  const std::uint32_t* inner_nodes = nullptr;  ///< first floats of packed nodes
  const Link* links = nullptr;
  const float* inner_rest_lengths = nullptr;  ///< [m]
  const float* inner_stiffnesses = nullptr;   ///< k [N/m]
  const float* inner_dampings = nullptr;      ///< c [N·s/m]
};

/// Sums over the rows of a chunk.
struct ChunkSums {
  double volume = 0;           ///< V of the chunk's fans [m³]
  double denominator = 0;      ///< gᵀM⁻¹g [m⁴/kg]
  double volume_velocity = 0;  ///< g·v̂ [m³/s]
};

/// One step's input and output. Nodes are three doubles each, one after the other, surface nodes
/// first. Positions can be read 8 bytes beyond the last surface node.
struct Step {
  double h = 0;                           ///< [s]
  double gravity[3 * kDoubleLanes] = {};  ///< of the coordinates of eight nodes [m/s²]
  double drag = 0;                        ///< [1/s]
  double origin[3 * kDoubleLanes] = {};   ///< the volume is taken about it [m]
  const double* positions = nullptr;      ///< [m]
  const double* velocities = nullptr;     ///< [m/s]
  const float* nodes = nullptr;           ///< positions and velocities, packed
  double* new_velocities = nullptr;       ///< v̂ of the surface nodes [m/s]
  double* gradient = nullptr;             ///< g [m²]  (surface_node_count)
  float* virtual_forces = nullptr;  ///< of the chunk's inner springs [N]  (chunk × virtual × 3 ×
                                    ///< kLanes)
  ChunkSums* sums = nullptr;        ///< (chunk_count)
};

/// Nodes of doubles into packed ones.
struct Packing {
  const double* positions = nullptr;   ///< [m]
  const double* velocities = nullptr;  ///< the second vectors; null: zeros
  double origin[4] = {};               ///< taken from the positions [m]
  float* nodes = nullptr;              ///< (kNodeFloats each)
};

/// v = v̂ − M⁻¹g σ and x += h v, coordinate by coordinate.
struct Move {
  double h = 0;                            ///< [s]
  double volume_impulse = 0;               ///< σ [Pa·s]
  const double* inverse_masses = nullptr;  ///< each node's three times [1/kg]
  const double* gradient = nullptr;        ///< [m²]
  double* velocities = nullptr;            ///< [m/s]
  double* positions = nullptr;             ///< [m]
};

/// The code of one instruction set.
struct Functions {
  /// Nodes [first, last); the node `last` can be read, too.
  void (*pack)(const Packing&, std::size_t first, std::size_t last);
  /// Forces and volume of one chunk.
  void (*step_chunk)(const Layout&, const Step&, std::size_t chunk);
  /// The same without volume: its gradient is neither written nor its sums.
  void (*step_chunk_without_volume)(const Layout&, const Step&, std::size_t chunk);
  /// Volume of one chunk, its gradient and sums alone; `velocities` stand for v̂.
  void (*volume_chunk)(const Layout&, const Step&, std::size_t chunk);
  /// Coordinates [first, last).
  void (*move)(const Move&, std::size_t first, std::size_t last);
  /// Σ ½k(l−l₀)² of one chunk's springs [J]; those between surface nodes are seen from both ends
  /// and count half each.
  double (*chunk_energy)(const Layout&, const Step&, std::size_t chunk);
};

const Functions& portable_functions();
#if defined(__x86_64__)
const Functions& avx2_functions();
const Functions& avx512_functions();
#endif

}  // namespace palpate::deformation::kernel
