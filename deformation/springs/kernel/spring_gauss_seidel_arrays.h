// How the visits of springs see an organ: plain arrays, four springs side by side.
//
// Known to the files compiled for one instruction set each, so it must stay free of inline library
// code (spring_kernel_arrays.h says why).
#pragma once

#include <cstddef>
#include <cstdint>

namespace palpate::deformation::kernel {

/// Springs of a batch.
inline constexpr std::size_t kVisitLanes = 4;

/// A visited node: x y z [m], then 1/m [1/kg].
inline constexpr std::size_t kVisitedDoubles = 4;

/// Added to l² [m²], so that a spring without length pulls at nothing.
inline constexpr double kTinyVisitSquare = 1e-60;

/// Springs of which no two share a node, so that they are visited at once as if one by one. Lanes
/// left over hold a spring from a node without a place in the organ to itself.
struct VisitBatch {
  std::uint32_t nodes_a[kVisitLanes] = {}, nodes_b[kVisitLanes] = {};  ///< first doubles
  double rest_lengths[kVisitLanes] = {};                               ///< l₀ [m]
  double flexibilities[kVisitLanes] = {};                              ///< 1/k [m/N]
  double damping_times[kVisitLanes] = {};                              ///< c/k [s]
};

/// One pass over all springs.
struct VisitPass {
  double per_h = 0;  ///< 1/h [1/s]
  const VisitBatch* batches = nullptr;
  std::size_t batch_count = 0;
  const double* start = nullptr;  ///< nodes where the step began
  double* nodes = nullptr;
  double* multipliers = nullptr;  ///< λ [kg m]  (batch × kVisitLanes); null: the only pass
};

using VisitSprings = void (*)(const VisitPass&);

VisitSprings portable_visits();
#if defined(__x86_64__)
VisitSprings avx2_visits();
#endif

}  // namespace palpate::deformation::kernel
