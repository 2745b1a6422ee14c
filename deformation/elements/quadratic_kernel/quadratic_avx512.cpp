// The kernel of quadratic tetrahedra for CPUs with AVX-512 F, DQ and VL.
#include "deformation/elements/quadratic_kernel/quadratic_body.h"
#include "deformation/packs/avx512_packs.h"

namespace palpate::deformation::kernel {
namespace {

struct Avx512Quads : Avx512Floats {
  using Number = float;
  struct Doubles : Avx512Doubles {
    using Number = double;
    static Pack load(const float* from) { return widen(from); }
  };

  static Pack join(const Quad* quads) {
    const auto low = __builtin_shufflevector(quads[0], quads[1], 0, 1, 2, 3, 4, 5, 6, 7);
    const auto high = __builtin_shufflevector(quads[2], quads[3], 0, 1, 2, 3, 4, 5, 6, 7);
    return __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  }
};

}  // namespace

QuadraticKernel avx512_quadratic_kernel() { return Quadratic<Avx512Quads>::kernel(); }

}  // namespace palpate::deformation::kernel
