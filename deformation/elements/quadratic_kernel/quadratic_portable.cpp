// The kernel of quadratic tetrahedra for any CPU.
#include "deformation/elements/quadratic_kernel/quadratic_body.h"
#include "deformation/packs/portable_packs.h"

namespace palpate::deformation::kernel {
namespace {

struct PortableQuads : PortableFloats {
  using Number = float;
  struct Doubles : PortableDoubles {
    using Number = double;
    static Pack load(const float* from) { return widen(from); }
    static Pack fma(const Pack& a, const Pack& b, const Pack& c) {
      return Pack{__builtin_fma(a[0], b[0], c[0]), __builtin_fma(a[1], b[1], c[1])};
    }
    static Pack fnma(const Pack& a, const Pack& b, const Pack& c) { return fma(-a, b, c); }
  };

  static Pack join(const Quad* quads) { return quads[0]; }
  /// Rounded once, as everywhere. Where the processor cannot, the C library does: exact, and slow.
  static Pack fma(const Pack& a, const Pack& b, const Pack& c) {
    return Pack{__builtin_fmaf(a[0], b[0], c[0]), __builtin_fmaf(a[1], b[1], c[1]),
                __builtin_fmaf(a[2], b[2], c[2]), __builtin_fmaf(a[3], b[3], c[3])};
  }
  static Pack fnma(const Pack& a, const Pack& b, const Pack& c) { return fma(-a, b, c); }
};

}  // namespace

QuadraticKernel portable_quadratic_kernel() { return Quadratic<PortableQuads>::kernel(); }

}  // namespace palpate::deformation::kernel
