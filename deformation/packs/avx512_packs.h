// Registers of CPUs with AVX-512 F, DQ and VL.
#pragma once

#include <immintrin.h>

#include <cstddef>
#include <cstdint>

#include "deformation/packs/vector3.h"

namespace palpate::deformation::kernel {
namespace {

// GCC 12 takes the undefined register of some plain intrinsics for an uninitialised variable; those
// with a mask, all ones here, and the compiler's own shuffle have none.

struct Avx512Floats {
  static constexpr std::size_t kWidth = 16;
  using Pack = __m512;
  using Bits = std::uint32_t __attribute__((vector_size(64)));

  static Pack broadcast(float value) { return _mm512_set1_ps(value); }
  static Pack load(const float* from) { return _mm512_loadu_ps(from); }
  static void store(float* to, const Pack& pack) { _mm512_storeu_ps(to, pack); }
  static Pack fma(const Pack& a, const Pack& b, const Pack& c) { return _mm512_fmadd_ps(a, b, c); }
  static Pack fnma(const Pack& a, const Pack& b, const Pack& c) {
    return _mm512_fnmadd_ps(a, b, c);
  }
  static Bits bits(const Pack& pack) { return reinterpret_cast<Bits>(pack); }
  static Pack of_bits(const Bits& bits) { return reinterpret_cast<Pack>(bits); }

  static Pack absolute(const Pack& x) { return of_bits(bits(x) & 0x7fffffffu); }
  static Pack larger(const Pack& a, const Pack& b, const Pack& yes, const Pack& no) {
    return _mm512_mask_blend_ps(_mm512_cmp_ps_mask(a, b, _CMP_GT_OQ), no, yes);
  }

  /// x of four nodes in each quarter, then y, then z, from x y z 0 of one in each.
  static Vector3<Avx512Floats> transposed(const Pack& a, const Pack& b, const Pack& c,
                                          const Pack& d) {
    const Pack xy_ab = _mm512_maskz_unpacklo_ps(0xffff, a, b);
    const Pack xy_cd = _mm512_maskz_unpacklo_ps(0xffff, c, d);
    const Pack z_ab = _mm512_maskz_unpackhi_ps(0xffff, a, b);
    const Pack z_cd = _mm512_maskz_unpackhi_ps(0xffff, c, d);
    return {_mm512_maskz_shuffle_ps(0xffff, xy_ab, xy_cd, 0b01000100),
            _mm512_maskz_shuffle_ps(0xffff, xy_ab, xy_cd, 0b11101110),
            _mm512_maskz_shuffle_ps(0xffff, z_ab, z_cd, 0b01000100)};
  }

  static Pack four(const float* base, const std::uint32_t* i) {
    Pack nodes = _mm512_castps128_ps512(_mm_loadu_ps(base + i[0]));
    nodes = _mm512_maskz_insertf32x4(0xffff, nodes, _mm_loadu_ps(base + i[4]), 1);
    nodes = _mm512_maskz_insertf32x4(0xffff, nodes, _mm_loadu_ps(base + i[8]), 2);
    return _mm512_maskz_insertf32x4(0xffff, nodes, _mm_loadu_ps(base + i[12]), 3);
  }
  static Vector3<Avx512Floats> load_nodes(const float* base, const std::uint32_t* i) {
    return transposed(four(base, i), four(base, i + 1), four(base, i + 2), four(base, i + 3));
  }

  /// Both vectors of two nodes.
  static Pack pair(const float* base, std::uint32_t low, std::uint32_t high) {
    return _mm512_maskz_insertf32x8(0xffff, _mm512_castps256_ps512(_mm256_loadu_ps(base + low)),
                                    _mm256_loadu_ps(base + high), 1);
  }
  /// In quarters: first vectors of nodes 0 to 3, second vectors, first of 4 to 7, second.
  static Vector3<Avx512Floats> eight(const float* base, const std::uint32_t* i) {
    return transposed(pair(base, i[0], i[4]), pair(base, i[1], i[5]), pair(base, i[2], i[6]),
                      pair(base, i[3], i[7]));
  }
  static Pack even(const Pack& a, const Pack& b) {
    return _mm512_maskz_shuffle_f32x4(0xffff, a, b, 0b10001000);
  }
  static Pack odd(const Pack& a, const Pack& b) {
    return _mm512_maskz_shuffle_f32x4(0xffff, a, b, 0b11011101);
  }
  static NodePairs<Avx512Floats> load_pairs(const float* base, const std::uint32_t* i) {
    const Vector3<Avx512Floats> a = eight(base, i), b = eight(base, i + 8);
    return {{even(a.x, b.x), even(a.y, b.y), even(a.z, b.z)},
            {odd(a.x, b.x), odd(a.y, b.y), odd(a.z, b.z)}};
  }

  static void store_nodes(float* base, const Vector3<Avx512Floats>& n) {
    const Pack none = _mm512_setzero_ps();
    const Pack xz_low = _mm512_maskz_unpacklo_ps(0xffff, n.x, n.z);
    const Pack xz_high = _mm512_maskz_unpackhi_ps(0xffff, n.x, n.z);
    const Pack y_low = _mm512_maskz_unpacklo_ps(0xffff, n.y, none);
    const Pack y_high = _mm512_maskz_unpackhi_ps(0xffff, n.y, none);
    store_quarters(base, _mm512_maskz_unpacklo_ps(0xffff, xz_low, y_low));
    store_quarters(base + 4, _mm512_maskz_unpackhi_ps(0xffff, xz_low, y_low));
    store_quarters(base + 8, _mm512_maskz_unpacklo_ps(0xffff, xz_high, y_high));
    store_quarters(base + 12, _mm512_maskz_unpackhi_ps(0xffff, xz_high, y_high));
  }
  static void store_quarters(float* to, const Pack& nodes) {
    _mm_storeu_ps(to, _mm512_maskz_extractf32x4_ps(0xf, nodes, 0));
    _mm_storeu_ps(to + 16, _mm512_maskz_extractf32x4_ps(0xf, nodes, 1));
    _mm_storeu_ps(to + 32, _mm512_maskz_extractf32x4_ps(0xf, nodes, 2));
    _mm_storeu_ps(to + 48, _mm512_maskz_extractf32x4_ps(0xf, nodes, 3));
  }

  static Pack root(const Pack& x) { return _mm512_maskz_sqrt_ps(0xffff, x); }
  static Pack gather_quads(const float* base, const std::uint32_t* i) {
    Pack quads = _mm512_castps128_ps512(_mm_loadu_ps(base + i[0]));
    quads = _mm512_maskz_insertf32x4(0xffff, quads, _mm_loadu_ps(base + i[1]), 1);
    quads = _mm512_maskz_insertf32x4(0xffff, quads, _mm_loadu_ps(base + i[2]), 2);
    return _mm512_maskz_insertf32x4(0xffff, quads, _mm_loadu_ps(base + i[3]), 3);
  }
  static void add_quads(float* base, const std::uint32_t* i, const Pack& quads) {
    add(base + i[0], _mm512_maskz_extractf32x4_ps(0xf, quads, 0));
    add(base + i[1], _mm512_maskz_extractf32x4_ps(0xf, quads, 1));
    add(base + i[2], _mm512_maskz_extractf32x4_ps(0xf, quads, 2));
    add(base + i[3], _mm512_maskz_extractf32x4_ps(0xf, quads, 3));
  }
  static void add(float* to, __m128 quad) { _mm_storeu_ps(to, _mm_loadu_ps(to) + quad); }
  static Vector4<Avx512Floats> transpose(const Pack& a, const Pack& b, const Pack& c,
                                         const Pack& d) {
    const Pack xy_ab = _mm512_maskz_unpacklo_ps(0xffff, a, b);
    const Pack xy_cd = _mm512_maskz_unpacklo_ps(0xffff, c, d);
    const Pack zw_ab = _mm512_maskz_unpackhi_ps(0xffff, a, b);
    const Pack zw_cd = _mm512_maskz_unpackhi_ps(0xffff, c, d);
    return {_mm512_maskz_shuffle_ps(0xffff, xy_ab, xy_cd, 0b01000100),
            _mm512_maskz_shuffle_ps(0xffff, xy_ab, xy_cd, 0b11101110),
            _mm512_maskz_shuffle_ps(0xffff, zw_ab, zw_cd, 0b01000100),
            _mm512_maskz_shuffle_ps(0xffff, zw_ab, zw_cd, 0b11101110)};
  }
  static __m128 fold(const Pack* all) {
    const __m256 sum =
        _mm512_maskz_extractf32x8_ps(0xff, *all, 0) + _mm512_maskz_extractf32x8_ps(0xff, *all, 1);
    return _mm256_castps256_ps128(sum) + _mm256_extractf128_ps(sum, 1);
  }

  static void pack_node(const double* from, const double* origin, float* to) {
    const __m256d node = _mm256_maskz_loadu_pd(0b111, from) - _mm256_loadu_pd(origin);
    _mm_storeu_ps(to, _mm256_cvtpd_ps(node));
  }
};

struct Avx512Doubles {
  static constexpr std::size_t kWidth = 8;
  using Pack = __m512d;

  static Pack broadcast(double value) { return _mm512_set1_pd(value); }
  static void store(double* to, const Pack& pack) { _mm512_storeu_pd(to, pack); }
  static Pack widen(const float* from) {
    return _mm512_maskz_cvtps_pd(0xff, _mm256_loadu_ps(from));
  }
  static Pack fma(const Pack& a, const Pack& b, const Pack& c) { return _mm512_fmadd_pd(a, b, c); }
  static Pack fnma(const Pack& a, const Pack& b, const Pack& c) {
    return _mm512_fnmadd_pd(a, b, c);
  }

  static Pack load(const double* from) { return _mm512_loadu_pd(from); }
  static Pack root(const Pack& x) { return _mm512_maskz_sqrt_pd(0xff, x); }
  static Pack larger(const Pack& a, const Pack& b, const Pack& yes, const Pack& no) {
    return _mm512_mask_blend_pd(_mm512_cmp_pd_mask(a, b, _CMP_GT_OQ), no, yes);
  }
  static bool any_larger(const Pack& a, const Pack& b) {
    return _mm512_cmp_pd_mask(a, b, _CMP_GT_OQ) != 0;
  }
  static void narrow(float* to, const Pack& pack) {
    _mm256_storeu_ps(to, _mm512_maskz_cvtpd_ps(0xff, pack));
  }

  /// Two nodes of four doubles, the second above the first.
  static Pack pair(const double* base, std::uint32_t low, std::uint32_t high) {
    const Pack half = _mm512_castpd256_pd512(_mm256_loadu_pd(base + low));
    return _mm512_maskz_insertf64x4(0xff, half, _mm256_loadu_pd(base + high), 1);
  }

  static Vector4<Avx512Doubles> load_quads(const double* base, const std::uint32_t* i) {
    const Pack a = pair(base, i[0], i[2]), b = pair(base, i[1], i[3]);
    const Pack c = pair(base, i[4], i[6]), d = pair(base, i[5], i[7]);
    const Pack xz_low = __builtin_shufflevector(a, b, 0, 8, 2, 10, 4, 12, 6, 14);
    const Pack xz_high = __builtin_shufflevector(c, d, 0, 8, 2, 10, 4, 12, 6, 14);
    const Pack y_low = __builtin_shufflevector(a, b, 1, 9, 3, 11, 5, 13, 7, 15);
    const Pack y_high = __builtin_shufflevector(c, d, 1, 9, 3, 11, 5, 13, 7, 15);
    return {__builtin_shufflevector(xz_low, xz_high, 0, 1, 4, 5, 8, 9, 12, 13),
            __builtin_shufflevector(y_low, y_high, 0, 1, 4, 5, 8, 9, 12, 13),
            __builtin_shufflevector(xz_low, xz_high, 2, 3, 6, 7, 10, 11, 14, 15),
            __builtin_shufflevector(y_low, y_high, 2, 3, 6, 7, 10, 11, 14, 15)};
  }
  static Vector3<Avx512Doubles> load_nodes(const double* base, const std::uint32_t* i) {
    const Vector4<Avx512Doubles> quads = load_quads(base, i);
    return {quads.x, quads.y, quads.z};
  }

  /// x0 y0 z0 x1 … z7 as three packs.
  static void store_nodes(double* base, const Vector3<Avx512Doubles>& n) {
    const __m512i xy0 = _mm512_setr_epi64(0, 8, 0, 1, 9, 0, 2, 10);
    const __m512i xy1 = _mm512_setr_epi64(0, 3, 11, 0, 4, 12, 0, 5);
    const __m512i xy2 = _mm512_setr_epi64(13, 0, 6, 14, 0, 7, 15, 0);
    const __m512i z0 = _mm512_setr_epi64(0, 1, 8, 3, 4, 9, 6, 7);
    const __m512i z1 = _mm512_setr_epi64(10, 1, 2, 11, 4, 5, 12, 7);
    const __m512i z2 = _mm512_setr_epi64(0, 13, 2, 3, 14, 5, 6, 15);
    store(base, _mm512_permutex2var_pd(_mm512_permutex2var_pd(n.x, xy0, n.y), z0, n.z));
    store(base + 8, _mm512_permutex2var_pd(_mm512_permutex2var_pd(n.x, xy1, n.y), z1, n.z));
    store(base + 16, _mm512_permutex2var_pd(_mm512_permutex2var_pd(n.x, xy2, n.y), z2, n.z));
  }
};

}  // namespace
}  // namespace palpate::deformation::kernel
