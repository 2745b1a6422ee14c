// The spring product for any CPU: four lanes at a time.
#include "deformation/spring_product_body.h"

namespace palpate::deformation::kernel {
namespace {

struct PortableFloat {
  static constexpr std::size_t kWidth = 4;
  using Pack = float __attribute__((vector_size(16)));

  static Pack broadcast(float value) { return Pack{value, value, value, value}; }
  static Pack load(const float* from) { return Pack{from[0], from[1], from[2], from[3]}; }
  static void store(float* to, const Pack& pack) {
    for (int lane = 0; lane < 4; ++lane) to[lane] = pack[lane];
  }
  static Pack fma(const Pack& a, const Pack& b, const Pack& c) { return a * b + c; }
  static Pack fnma(const Pack& a, const Pack& b, const Pack& c) { return c - a * b; }
  static Pack root(const Pack& x) {
    return Pack{__builtin_sqrtf(x[0]), __builtin_sqrtf(x[1]), __builtin_sqrtf(x[2]),
                __builtin_sqrtf(x[3])};
  }
  static Pack absolute(const Pack& x) {
    return Pack{__builtin_fabsf(x[0]), __builtin_fabsf(x[1]), __builtin_fabsf(x[2]),
                __builtin_fabsf(x[3])};
  }
  static Pack keep_below(const Pack& values, const Pack& a, const Pack& b) {
    Pack kept{};
    for (int lane = 0; lane < 4; ++lane) kept[lane] = a[lane] < b[lane] ? values[lane] : 0;
    return kept;
  }

  static Vector3<PortableFloat> load_nodes(const float* base, const std::uint32_t* i) {
    const float *a = base + 4ul * i[0], *b = base + 4ul * i[1];
    const float *c = base + 4ul * i[2], *d = base + 4ul * i[3];
    return {Pack{a[0], b[0], c[0], d[0]}, Pack{a[1], b[1], c[1], d[1]},
            Pack{a[2], b[2], c[2], d[2]}};
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
