// The kernel of quadratic tetrahedra for CPUs with AVX2.
#include "deformation/elements/quadratic_kernel/quadratic_body.h"
#include "deformation/packs/avx2_packs.h"

namespace palpate::deformation::kernel {
namespace {

struct Avx2Quads : Avx2Floats {
  using Number = float;
  struct Doubles : Avx2Doubles {
    using Number = double;
    static Pack load(const float* from) { return widen(from); }
  };

  static Pack join(const Quad* quads) {
    return __builtin_shufflevector(quads[0], quads[1], 0, 1, 2, 3, 4, 5, 6, 7);
  }
};

}  // namespace

QuadraticKernel avx2_quadratic_kernel() { return Quadratic<Avx2Quads>::kernel(); }

}  // namespace palpate::deformation::kernel
