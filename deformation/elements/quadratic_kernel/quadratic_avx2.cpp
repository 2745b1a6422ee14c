// The kernel of quadratic tetrahedra for CPUs with AVX2.
#include <immintrin.h>

#include "deformation/elements/quadratic_kernel/quadratic_body.h"

namespace palpate::deformation::kernel {
namespace {

struct Avx2Quads {
  struct Doubles {
    static constexpr std::size_t kWidth = 4;
    using Number = double;
    using Pack = double __attribute__((vector_size(32)));
    using Unaligned = float __attribute__((vector_size(16), aligned(4), may_alias));

    static Pack fma(const Pack& a, const Pack& b, const Pack& c) {
      return _mm256_fmadd_pd(a, b, c);
    }
    static Pack fnma(const Pack& a, const Pack& b, const Pack& c) {
      return _mm256_fnmadd_pd(a, b, c);
    }
  };

  static constexpr std::size_t kWidth = 8;
  using Number = float;
  using Pack = float __attribute__((vector_size(32)));
  using Unaligned = float __attribute__((vector_size(32), aligned(4), may_alias));

  static Pack join(const Quad* quads) {
    return __builtin_shufflevector(quads[0], quads[1], 0, 1, 2, 3, 4, 5, 6, 7);
  }
  static Pack fma(const Pack& a, const Pack& b, const Pack& c) { return _mm256_fmadd_ps(a, b, c); }
  static Pack fnma(const Pack& a, const Pack& b, const Pack& c) {
    return _mm256_fnmadd_ps(a, b, c);
  }
  static Pack root(const Pack& x) { return _mm256_sqrt_ps(x); }
};

}  // namespace

QuadraticKernel avx2_quadratic_kernel() { return Quadratic<Avx2Quads>::kernel(); }

}  // namespace palpate::deformation::kernel
