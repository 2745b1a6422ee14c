// What the spring product keeps of an implicit step's matrix, beside the slices of
// spring_kernel_arrays.h.
//
// Known to the files compiled for one instruction set each; free of inline library code like those.
#pragma once

#include "deformation/springs/kernel/spring_kernel_arrays.h"

namespace palpate::deformation::kernel {

/// Numbers per lane of a node's diagonal block: Σ along d dᵀ as xx, xy, xz, yy, yz, zz, and Σ
/// across.
inline constexpr std::size_t kBlockNumbers = 7;

/// h J = along d dᵀ + across I of every half-spring, and where nodes are.
struct Couplings {
  float h = 0;        ///< [s]
  float damping = 1;  ///< what counts of c
  /// Positions [m], and vectors the matrix is to be applied to, packed.
  const float* nodes = nullptr;
  /// Both of a spring in the place of one float: the upper halves of their bits, rounded to eight
  /// digits, `along` above `across`.  (slots × kLanes)
  float* pairs = nullptr;
  float *inner_along = nullptr, *inner_across = nullptr;  ///< (row_count)
};

/// Some of the slices, by their indices.
struct SliceList {
  const std::uint32_t* slices = nullptr;
  std::size_t count = 0;
};

/// The code of one instruction set, for some slices.
struct ProductFunctions {
  /// Fills the couplings and adds up the blocks of the rows (kBlockNumbers × kLanes per slice) and,
  /// zeroed here, of the virtual nodes (kBlockNumbers × kLanes each).
  void (*linearise)(const Layout&, const Couplings&, const SliceList&, float* blocks,
                    float* virtual_blocks);
  /// out = masses p + Σ h J (p − p_j) of the surface nodes, four floats each; virtual_sums
  /// (3 × kLanes each), zeroed here, get what the inner springs add to the virtual nodes; dots
  /// (kLanes) get p·out of the rows.
  void (*apply)(const Layout&, const Couplings&, const SliceList&, const float* masses, float* out,
                float* virtual_sums, float* dots);
};

const ProductFunctions& portable_product_functions();
#if defined(__x86_64__)
const ProductFunctions& avx2_product_functions();
const ProductFunctions& avx512_product_functions();
#endif

}  // namespace palpate::deformation::kernel
