// The kernel of quadratic tetrahedra for CPUs with AVX-512 F, DQ and VL.
#include <immintrin.h>

#include "deformation/elements/quadratic_kernel/quadratic_body.h"

namespace palpate::deformation::kernel {
namespace {

struct Avx512Quads {
  struct Doubles {
    static constexpr std::size_t kWidth = 8;
    using Number = double;
    using Pack = double __attribute__((vector_size(64)));
    using Unaligned = float __attribute__((vector_size(32), aligned(4), may_alias));

    static Pack fma(const Pack& a, const Pack& b, const Pack& c) {
      return _mm512_fmadd_pd(a, b, c);
    }
    static Pack fnma(const Pack& a, const Pack& b, const Pack& c) {
      return _mm512_fnmadd_pd(a, b, c);
    }
  };

  static constexpr std::size_t kWidth = 16;
  using Number = float;
  using Pack = float __attribute__((vector_size(64)));
  using Unaligned = float __attribute__((vector_size(64), aligned(4), may_alias));

  static Pack join(const Quad* quads) {
    const auto low = __builtin_shufflevector(quads[0], quads[1], 0, 1, 2, 3, 4, 5, 6, 7);
    const auto high = __builtin_shufflevector(quads[2], quads[3], 0, 1, 2, 3, 4, 5, 6, 7);
    return __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  }
  static Pack fma(const Pack& a, const Pack& b, const Pack& c) { return _mm512_fmadd_ps(a, b, c); }
  static Pack fnma(const Pack& a, const Pack& b, const Pack& c) {
    return _mm512_fnmadd_ps(a, b, c);
  }
  /// With a mask, all ones: GCC 12 takes the plain one's undefined register for uninitialised.
  static Pack root(const Pack& x) { return _mm512_maskz_sqrt_ps(0xffff, x); }
};

}  // namespace

QuadraticKernel avx512_quadratic_kernel() { return Quadratic<Avx512Quads>::kernel(); }

}  // namespace palpate::deformation::kernel
