// How the spring product sees an organ: the slices of spring_kernel_arrays.h, in float.
//
// Known to the files compiled for one instruction set each; free of inline library code like those.
#pragma once

#include "deformation/spring_kernel_arrays.h"

namespace palpate::deformation::kernel {

/// Numbers per lane of a node's diagonal block: Σ along d dᵀ as xx, xy, xz, yy, yz, zz, and Σ
/// across.
inline constexpr std::size_t kBlockNumbers = 7;

/// Link in float.
struct ProductLink {
  std::uint32_t virtual_node = 0;
  float weights[kLanes] = {};
};

/// Constant per organ.
struct ProductLayout {
  std::size_t surface_node_count = 0, virtual_node_count = 0;
  std::size_t slices_per_chunk = 0, chunk_count = 0, slice_count = 0;
  const Slice* slices = nullptr;                          ///< (slice_count)
  const ProductLink* links = nullptr;                     ///< of the slices
  const std::uint32_t* neighbours = nullptr;              ///< nodes  (slots × kLanes)
  const float* rest_lengths = nullptr;                    ///< l₀ [m]  (slots × kLanes)
  const std::uint32_t* row_nodes = nullptr;               ///< (row_count)
  const float* ring_sizes = nullptr;                      ///< (row_count)
  float structural_stiffness = 0, bending_stiffness = 0;  ///< k [N/m]
  float structural_damping = 0, bending_damping = 0;      ///< c [N·s/m]
  // Inner springs, one per row, absent without virtual nodes.
  const std::uint32_t* inner_nodes = nullptr;  ///< nodes
  const float* inner_rest_lengths = nullptr;   ///< [m]
  const float* inner_stiffnesses = nullptr;    ///< [N/m]
  const float* inner_dampings = nullptr;       ///< [N·s/m]
};

/// h J = along d dᵀ + across I of every half-spring, and where nodes are. Nodes are four floats.
struct Couplings {
  float h = 0;                                            ///< [s]
  const float* positions = nullptr;                       ///< [m], from some node of the organ
  float *along = nullptr, *across = nullptr;              ///< (slots × kLanes)
  float *inner_along = nullptr, *inner_across = nullptr;  ///< (row_count)
};

/// The code of one instruction set, for one chunk.
struct ProductFunctions {
  /// Fills the couplings and adds up the blocks of the rows (kBlockNumbers × kLanes per slice) and,
  /// zeroed here, of the virtual nodes (kBlockNumbers × kLanes each).
  void (*linearise)(const ProductLayout&, const Couplings&, std::size_t chunk, float* blocks,
                    float* virtual_blocks);
  /// out = masses p + Σ h J (p − p_j) of the surface nodes; virtual_sums (3 × kLanes each), zeroed
  /// here, get what the inner springs add to the virtual nodes.
  void (*apply)(const ProductLayout&, const Couplings&, std::size_t chunk, const float* masses,
                const float* p, float* out, float* virtual_sums);
};

const ProductFunctions& portable_product_functions();
#if defined(__x86_64__)
const ProductFunctions& avx2_product_functions();
#endif

}  // namespace palpate::deformation::kernel
