// The spring kernel for any CPU: two lanes at a time, as the baseline of both x86-64 and AArch64
// has them.
#include "deformation/spring_kernel_body.h"

namespace palpate::deformation::kernel {
namespace {

struct Portable {
  static constexpr std::size_t kWidth = 2;
  using Pack = double __attribute__((vector_size(16)));
  using Unaligned = double __attribute__((vector_size(16), aligned(8), may_alias));

  static Pack broadcast(double value) { return Pack{value, value}; }
  static Pack load(const double* from) { return *reinterpret_cast<const Unaligned*>(from); }
  static void store(double* to, const Pack& pack) { *reinterpret_cast<Unaligned*>(to) = pack; }

  static Pack fma(const Pack& a, const Pack& b, const Pack& c) { return a * b + c; }
  static Pack fnma(const Pack& a, const Pack& b, const Pack& c) { return c - a * b; }

  static Vector3<Portable> load_nodes(const double* base, const std::uint32_t* i) {
    const double *a = base + i[0], *b = base + i[1];
    return {Pack{a[0], b[0]}, Pack{a[1], b[1]}, Pack{a[2], b[2]}};
  }

  static void store_nodes(double* base, const Vector3<Portable>& n) {
    for (int lane = 0; lane < 2; ++lane, base += 3) {
      base[0] = n.x[lane];
      base[1] = n.y[lane];
      base[2] = n.z[lane];
    }
  }

  static double inverse_root_guess(double x) {
    return static_cast<double>(1.0f / __builtin_sqrtf(static_cast<float>(x)));
  }
  static Pack inverse_root_guess(const Pack& x) {
    return Pack{inverse_root_guess(x[0]), inverse_root_guess(x[1])};
  }

  static Pack keep_below(const Pack& values, const Pack& a, const Pack& b) {
    return a < b ? values : Pack{};
  }
};

}  // namespace

const Functions& portable_functions() { return Kernel<Portable>::functions; }

}  // namespace palpate::deformation::kernel
