// The kernel of quadratic tetrahedra for any CPU: registers of 128 bits, as the baseline of both
// x86-64 and AArch64 has them.
#include "deformation/elements/quadratic_kernel/quadratic_body.h"

namespace palpate::deformation::kernel {
namespace {

struct PortableQuads {
  static constexpr std::size_t kWidth = 4;
  using Pack = float __attribute__((vector_size(16)));
  using Unaligned = float __attribute__((vector_size(16), aligned(4), may_alias));

  static Pack join(const Quad* quads) { return quads[0]; }
  static Pack root(const Pack& x) {
    return Pack{__builtin_sqrtf(x[0]), __builtin_sqrtf(x[1]), __builtin_sqrtf(x[2]),
                __builtin_sqrtf(x[3])};
  }
};

}  // namespace

QuadraticKernel portable_quadratic_kernel() { return Quadratic<PortableQuads>::kernel(); }

}  // namespace palpate::deformation::kernel
