// Registers of any CPU: 128 bits, as the baseline of both x86-64 and AArch64 has them.
#pragma once

#include <cstddef>
#include <cstdint>

#include "deformation/packs/vector3.h"

namespace palpate::deformation::kernel {
namespace {

struct PortableFloats {
  static constexpr std::size_t kWidth = 4;
  using Pack = float __attribute__((vector_size(16)));
  using Bits = std::uint32_t __attribute__((vector_size(16)));
  using Unaligned = float __attribute__((vector_size(16), aligned(4), may_alias));

  static Pack broadcast(float value) { return Pack{value, value, value, value}; }
  static Pack load(const float* from) { return *reinterpret_cast<const Unaligned*>(from); }
  static void store(float* to, const Pack& pack) { *reinterpret_cast<Unaligned*>(to) = pack; }
  static Pack fma(const Pack& a, const Pack& b, const Pack& c) { return a * b + c; }
  static Pack fnma(const Pack& a, const Pack& b, const Pack& c) { return c - a * b; }
  static Bits bits(const Pack& pack) { return reinterpret_cast<Bits>(pack); }
  static Pack of_bits(const Bits& bits) { return reinterpret_cast<Pack>(bits); }

  static Pack absolute(const Pack& x) { return of_bits(bits(x) & 0x7fffffffu); }
  static Pack larger(const Pack& a, const Pack& b, const Pack& yes, const Pack& no) {
    return a > b ? yes : no;
  }

  static Vector3<PortableFloats> load_nodes(const float* base, const std::uint32_t* i) {
    const Pack a = load(base + i[0]), b = load(base + i[1]);
    const Pack c = load(base + i[2]), d = load(base + i[3]);
    const Pack xy_ab = __builtin_shufflevector(a, b, 0, 4, 1, 5);
    const Pack xy_cd = __builtin_shufflevector(c, d, 0, 4, 1, 5);
    const Pack z_ab = __builtin_shufflevector(a, b, 2, 6, 3, 7);
    const Pack z_cd = __builtin_shufflevector(c, d, 2, 6, 3, 7);
    return {__builtin_shufflevector(xy_ab, xy_cd, 0, 1, 4, 5),
            __builtin_shufflevector(xy_ab, xy_cd, 2, 3, 6, 7),
            __builtin_shufflevector(z_ab, z_cd, 0, 1, 4, 5)};
  }
  static NodePairs<PortableFloats> load_pairs(const float* base, const std::uint32_t* i) {
    return {load_nodes(base, i), load_nodes(base + 4, i)};
  }

  static void store_nodes(float* base, const Vector3<PortableFloats>& n) {
    for (int lane = 0; lane < 4; ++lane, base += 4) {
      base[0] = n.x[lane];
      base[1] = n.y[lane];
      base[2] = n.z[lane];
      base[3] = 0;
    }
  }

  static Pack root(const Pack& x) {
    return Pack{__builtin_sqrtf(x[0]), __builtin_sqrtf(x[1]), __builtin_sqrtf(x[2]),
                __builtin_sqrtf(x[3])};
  }
  static Pack gather_quads(const float* base, const std::uint32_t* i) { return load(base + i[0]); }
  static void add_quads(float* base, const std::uint32_t* i, const Pack& quad) {
    store(base + i[0], load(base + i[0]) + quad);
  }
  static Vector4<PortableFloats> transpose(const Pack& a, const Pack& b, const Pack& c,
                                           const Pack& d) {
    const Pack xy_ab = __builtin_shufflevector(a, b, 0, 4, 1, 5);
    const Pack xy_cd = __builtin_shufflevector(c, d, 0, 4, 1, 5);
    const Pack zw_ab = __builtin_shufflevector(a, b, 2, 6, 3, 7);
    const Pack zw_cd = __builtin_shufflevector(c, d, 2, 6, 3, 7);
    return {__builtin_shufflevector(xy_ab, xy_cd, 0, 1, 4, 5),
            __builtin_shufflevector(xy_ab, xy_cd, 2, 3, 6, 7),
            __builtin_shufflevector(zw_ab, zw_cd, 0, 1, 4, 5),
            __builtin_shufflevector(zw_ab, zw_cd, 2, 3, 6, 7)};
  }
  static Pack fold(const Pack* q) { return (q[0] + q[2]) + (q[1] + q[3]); }

  static void pack_node(const double* from, const double* origin, float* to) {
    for (int axis = 0; axis < 3; ++axis) to[axis] = static_cast<float>(from[axis] - origin[axis]);
    to[3] = 0;
  }
};

struct PortableDoubles {
  static constexpr std::size_t kWidth = 2;
  using Pack = double __attribute__((vector_size(16)));

  static Pack broadcast(double value) { return Pack{value, value}; }
  static void store(double* to, const Pack& pack) {
    to[0] = pack[0];
    to[1] = pack[1];
  }
  static Pack widen(const float* from) { return Pack{from[0], from[1]}; }
  static Pack load(const double* from) { return Pack{from[0], from[1]}; }
  static Pack fma(const Pack& a, const Pack& b, const Pack& c) { return a * b + c; }
  static Pack fnma(const Pack& a, const Pack& b, const Pack& c) { return c - a * b; }
  static Pack root(const Pack& x) { return Pack{__builtin_sqrt(x[0]), __builtin_sqrt(x[1])}; }
  static Pack larger(const Pack& a, const Pack& b, const Pack& yes, const Pack& no) {
    return a > b ? yes : no;
  }
  static bool any_larger(const Pack& a, const Pack& b) { return a[0] > b[0] || a[1] > b[1]; }
  static void narrow(float* to, const Pack& pack) {
    to[0] = static_cast<float>(pack[0]);
    to[1] = static_cast<float>(pack[1]);
  }

  static Vector4<PortableDoubles> load_quads(const double* base, const std::uint32_t* i) {
    const double *a = base + i[0], *b = base + i[1];
    return {Pack{a[0], b[0]}, Pack{a[1], b[1]}, Pack{a[2], b[2]}, Pack{a[3], b[3]}};
  }
  static Vector3<PortableDoubles> load_nodes(const double* base, const std::uint32_t* i) {
    const double *a = base + i[0], *b = base + i[1];
    return {Pack{a[0], b[0]}, Pack{a[1], b[1]}, Pack{a[2], b[2]}};
  }

  static void store_nodes(double* base, const Vector3<PortableDoubles>& n) {
    for (int lane = 0; lane < 2; ++lane, base += 3) {
      base[0] = n.x[lane];
      base[1] = n.y[lane];
      base[2] = n.z[lane];
    }
  }
};

}  // namespace
}  // namespace palpate::deformation::kernel
