// The kernel of quadratic tetrahedra for any CPU: registers of 128 bits, as the baseline of both
// x86-64 and AArch64 has them.
#include "deformation/elements/quadratic_kernel/quadratic_body.h"

namespace palpate::deformation::kernel {
namespace {

struct PortableQuads {
  struct Doubles {
    static constexpr std::size_t kWidth = 2;
    using Number = double;
    using Pack = double __attribute__((vector_size(16)));
    using Unaligned = float __attribute__((vector_size(8), aligned(4), may_alias));

    static Pack fma(const Pack& a, const Pack& b, const Pack& c) {
      return Pack{__builtin_fma(a[0], b[0], c[0]), __builtin_fma(a[1], b[1], c[1])};
    }
    static Pack fnma(const Pack& a, const Pack& b, const Pack& c) { return fma(-a, b, c); }
  };

  static constexpr std::size_t kWidth = 4;
  using Number = float;
  using Pack = float __attribute__((vector_size(16)));
  using Unaligned = float __attribute__((vector_size(16), aligned(4), may_alias));

  static Pack join(const Quad* quads) { return quads[0]; }
  /// Where the processor cannot, the C library does: exact, and slow.
  static Pack fma(const Pack& a, const Pack& b, const Pack& c) {
    return Pack{__builtin_fmaf(a[0], b[0], c[0]), __builtin_fmaf(a[1], b[1], c[1]),
                __builtin_fmaf(a[2], b[2], c[2]), __builtin_fmaf(a[3], b[3], c[3])};
  }
  static Pack fnma(const Pack& a, const Pack& b, const Pack& c) { return fma(-a, b, c); }
  static Pack root(const Pack& x) {
    return Pack{__builtin_sqrtf(x[0]), __builtin_sqrtf(x[1]), __builtin_sqrtf(x[2]),
                __builtin_sqrtf(x[3])};
  }
};

}  // namespace

QuadraticKernel portable_quadratic_kernel() { return Quadratic<PortableQuads>::kernel(); }

}  // namespace palpate::deformation::kernel
