// Visits of springs for any CPU: registers of 128 bits, as the baseline of both x86-64 and AArch64
// has them.
#include "deformation/springs/kernel/spring_gauss_seidel_body.h"

namespace palpate::deformation::kernel {
namespace {

struct PortableVisits {
  static constexpr std::size_t kWidth = 2;
  using Pack = double __attribute__((vector_size(16)));
  using Unaligned = double __attribute__((vector_size(16), aligned(8), may_alias));

  static Pack broadcast(double value) { return Pack{value, value}; }
  static Pack load(const double* from) { return *reinterpret_cast<const Unaligned*>(from); }
  static void store(double* to, const Pack& pack) { *reinterpret_cast<Unaligned*>(to) = pack; }
  static Pack root(const Pack& x) { return Pack{__builtin_sqrt(x[0]), __builtin_sqrt(x[1])}; }

  static VisitedNodes<PortableVisits> load_nodes(const double* base, const std::uint32_t* i) {
    const Pack xy_a = load(base + i[0]), zw_a = load(base + i[0] + 2);
    const Pack xy_b = load(base + i[1]), zw_b = load(base + i[1] + 2);
    return {__builtin_shufflevector(xy_a, xy_b, 0, 2), __builtin_shufflevector(xy_a, xy_b, 1, 3),
            __builtin_shufflevector(zw_a, zw_b, 0, 2), __builtin_shufflevector(zw_a, zw_b, 1, 3)};
  }

  static void store_nodes(double* base, const std::uint32_t* i,
                          const VisitedNodes<PortableVisits>& n) {
    store(base + i[0], __builtin_shufflevector(n.x, n.y, 0, 2));
    store(base + i[0] + 2, __builtin_shufflevector(n.z, n.inverse_mass, 0, 2));
    store(base + i[1], __builtin_shufflevector(n.x, n.y, 1, 3));
    store(base + i[1] + 2, __builtin_shufflevector(n.z, n.inverse_mass, 1, 3));
  }
};

}  // namespace

VisitSprings portable_visits() { return &Visitor<PortableVisits>::run; }

}  // namespace palpate::deformation::kernel
