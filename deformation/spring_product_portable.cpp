// The spring product for any CPU: four lanes at a time.
#include "deformation/spring_product_body.h"

namespace palpate::deformation::kernel {
namespace {

struct PortableFloat {
  static constexpr std::size_t kWidth = 4;
  using Pack = float __attribute__((vector_size(16)));
  using Unaligned = float __attribute__((vector_size(16), aligned(4), may_alias));

  static Pack broadcast(float value) { return Pack{value, value, value, value}; }
  static Pack load(const float* from) { return *reinterpret_cast<const Unaligned*>(from); }
  static void store(float* to, const Pack& pack) { *reinterpret_cast<Unaligned*>(to) = pack; }
  static Pack fma(const Pack& a, const Pack& b, const Pack& c) { return a * b + c; }
  static Pack fnma(const Pack& a, const Pack& b, const Pack& c) { return c - a * b; }
  static Pack root(const Pack& x) {
    return Pack{__builtin_sqrtf(x[0]), __builtin_sqrtf(x[1]), __builtin_sqrtf(x[2]),
                __builtin_sqrtf(x[3])};
  }
  static Pack absolute(const Pack& x) { return x < 0 ? -x : x; }
  static Pack keep_below(const Pack& values, const Pack& a, const Pack& b) {
    return a < b ? values : Pack{};
  }

  static Vector3<PortableFloat> load_nodes(const float* base, const std::uint32_t* i) {
    const Pack a = load(base + 4ul * i[0]), b = load(base + 4ul * i[1]);
    const Pack c = load(base + 4ul * i[2]), d = load(base + 4ul * i[3]);
    const Pack xy_ab = __builtin_shufflevector(a, b, 0, 4, 1, 5);
    const Pack xy_cd = __builtin_shufflevector(c, d, 0, 4, 1, 5);
    const Pack z_ab = __builtin_shufflevector(a, b, 2, 6, 3, 7);
    const Pack z_cd = __builtin_shufflevector(c, d, 2, 6, 3, 7);
    return {__builtin_shufflevector(xy_ab, xy_cd, 0, 1, 4, 5),
            __builtin_shufflevector(xy_ab, xy_cd, 2, 3, 6, 7),
            __builtin_shufflevector(z_ab, z_cd, 0, 1, 4, 5)};
  }
  static void store_nodes(float* base, const Vector3<PortableFloat>& n) {
    for (int lane = 0; lane < 4; ++lane, base += 4) {
      base[0] = n.x[lane];
      base[1] = n.y[lane];
      base[2] = n.z[lane];
      base[3] = 0;
    }
  }
};

}  // namespace

const ProductFunctions& portable_product_functions() { return Product<PortableFloat>::functions; }

}  // namespace palpate::deformation::kernel
