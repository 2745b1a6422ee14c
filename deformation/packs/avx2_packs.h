// Registers of CPUs with AVX2 and FMA.
#pragma once

#include <immintrin.h>

#include <cstddef>
#include <cstdint>

#include "deformation/packs/vector3.h"

namespace palpate::deformation::kernel {
namespace {

struct Avx2Floats {
  static constexpr std::size_t kWidth = 8;
  using Pack = __m256;
  using Bits = std::uint32_t __attribute__((vector_size(32)));

  static Pack broadcast(float value) { return _mm256_set1_ps(value); }
  static Pack load(const float* from) { return _mm256_loadu_ps(from); }
  static void store(float* to, const Pack& pack) { _mm256_storeu_ps(to, pack); }
  static Pack fma(const Pack& a, const Pack& b, const Pack& c) { return _mm256_fmadd_ps(a, b, c); }
  static Pack fnma(const Pack& a, const Pack& b, const Pack& c) {
    return _mm256_fnmadd_ps(a, b, c);
  }
  static Bits bits(const Pack& pack) { return reinterpret_cast<Bits>(pack); }
  static Pack of_bits(const Bits& bits) { return reinterpret_cast<Pack>(bits); }

  static Pack absolute(const Pack& x) { return of_bits(bits(x) & 0x7fffffffu); }
  static Pack larger(const Pack& a, const Pack& b, const Pack& yes, const Pack& no) {
    return _mm256_blendv_ps(no, yes, _mm256_cmp_ps(a, b, _CMP_GT_OQ));
  }

  /// Two nodes, the second above the first.
  static Pack pair(const float* base, std::uint32_t low, std::uint32_t high) {
    return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(base + low)),
                                _mm_loadu_ps(base + high), 1);
  }
  static Vector3<Avx2Floats> load_nodes(const float* base, const std::uint32_t* i) {
    const Pack a = pair(base, i[0], i[4]), b = pair(base, i[1], i[5]);
    const Pack c = pair(base, i[2], i[6]), d = pair(base, i[3], i[7]);
    const Pack xy_ab = _mm256_unpacklo_ps(a, b), xy_cd = _mm256_unpacklo_ps(c, d);
    const Pack z_ab = _mm256_unpackhi_ps(a, b), z_cd = _mm256_unpackhi_ps(c, d);
    return {_mm256_shuffle_ps(xy_ab, xy_cd, 0b01000100),
            _mm256_shuffle_ps(xy_ab, xy_cd, 0b11101110), _mm256_shuffle_ps(z_ab, z_cd, 0b01000100)};
  }
  static NodePairs<Avx2Floats> load_pairs(const float* base, const std::uint32_t* i) {
    return {load_nodes(base, i), load_nodes(base + 4, i)};
  }

  static void store_nodes(float* base, const Vector3<Avx2Floats>& n) {
    const Pack none = _mm256_setzero_ps();
    const Pack xz_low = _mm256_unpacklo_ps(n.x, n.z), xz_high = _mm256_unpackhi_ps(n.x, n.z);
    const Pack y_low = _mm256_unpacklo_ps(n.y, none), y_high = _mm256_unpackhi_ps(n.y, none);
    const Pack nodes[4] = {_mm256_unpacklo_ps(xz_low, y_low), _mm256_unpackhi_ps(xz_low, y_low),
                           _mm256_unpacklo_ps(xz_high, y_high),
                           _mm256_unpackhi_ps(xz_high, y_high)};
    for (std::size_t k = 0; k < 4; ++k) {
      _mm_storeu_ps(base + 4 * k, _mm256_castps256_ps128(nodes[k]));
      _mm_storeu_ps(base + 16 + 4 * k, _mm256_extractf128_ps(nodes[k], 1));
    }
  }

  static Pack root(const Pack& x) { return _mm256_sqrt_ps(x); }
  static Pack gather_quads(const float* base, const std::uint32_t* i) {
    return pair(base, i[0], i[1]);
  }
  static void add_quads(float* base, const std::uint32_t* i, const Pack& quads) {
    add(base + i[0], _mm256_castps256_ps128(quads));
    add(base + i[1], _mm256_extractf128_ps(quads, 1));
  }
  static void add(float* to, __m128 quad) { _mm_storeu_ps(to, _mm_loadu_ps(to) + quad); }
  static Vector4<Avx2Floats> transpose(const Pack& a, const Pack& b, const Pack& c, const Pack& d) {
    const Pack xy_ab = _mm256_unpacklo_ps(a, b), xy_cd = _mm256_unpacklo_ps(c, d);
    const Pack zw_ab = _mm256_unpackhi_ps(a, b), zw_cd = _mm256_unpackhi_ps(c, d);
    return {
        _mm256_shuffle_ps(xy_ab, xy_cd, 0b01000100), _mm256_shuffle_ps(xy_ab, xy_cd, 0b11101110),
        _mm256_shuffle_ps(zw_ab, zw_cd, 0b01000100), _mm256_shuffle_ps(zw_ab, zw_cd, 0b11101110)};
  }
  static __m128 fold(const Pack* halves) {
    const Pack sum = halves[0] + halves[1];
    return _mm256_castps256_ps128(sum) + _mm256_extractf128_ps(sum, 1);
  }

  static void pack_node(const double* from, const double* origin, float* to) {
    const __m256i three = _mm256_setr_epi64x(-1, -1, -1, 0);
    _mm_storeu_ps(to, _mm256_cvtpd_ps(_mm256_maskload_pd(from, three) - _mm256_loadu_pd(origin)));
  }
};

struct Avx2Doubles {
  static constexpr std::size_t kWidth = 4;
  using Pack = __m256d;

  static Pack broadcast(double value) { return _mm256_set1_pd(value); }
  static void store(double* to, const Pack& pack) { _mm256_storeu_pd(to, pack); }
  static Pack widen(const float* from) { return _mm256_cvtps_pd(_mm_loadu_ps(from)); }
  static Pack fma(const Pack& a, const Pack& b, const Pack& c) { return _mm256_fmadd_pd(a, b, c); }
  static Pack fnma(const Pack& a, const Pack& b, const Pack& c) {
    return _mm256_fnmadd_pd(a, b, c);
  }

  static Pack load(const double* from) { return _mm256_loadu_pd(from); }
  static Pack root(const Pack& x) { return _mm256_sqrt_pd(x); }
  static Pack larger(const Pack& a, const Pack& b, const Pack& yes, const Pack& no) {
    return _mm256_blendv_pd(no, yes, _mm256_cmp_pd(a, b, _CMP_GT_OQ));
  }
  static bool any_larger(const Pack& a, const Pack& b) {
    return _mm256_movemask_pd(_mm256_cmp_pd(a, b, _CMP_GT_OQ)) != 0;
  }
  static void narrow(float* to, const Pack& pack) { _mm_storeu_ps(to, _mm256_cvtpd_ps(pack)); }

  static Vector4<Avx2Doubles> load_quads(const double* base, const std::uint32_t* i) {
    const Pack a = pair(base, i[0], i[2]), b = pair(base, i[1], i[3]);
    const Pack c = pair(base + 2, i[0], i[2]), d = pair(base + 2, i[1], i[3]);
    return {_mm256_unpacklo_pd(a, b), _mm256_unpackhi_pd(a, b), _mm256_unpacklo_pd(c, d),
            _mm256_unpackhi_pd(c, d)};
  }

  /// Two doubles of two nodes, the second node's above the first's.
  static Pack pair(const double* base, std::uint32_t low, std::uint32_t high) {
    const Pack half = _mm256_castpd128_pd256(_mm_loadu_pd(base + low));
    return _mm256_insertf128_pd(half, _mm_loadu_pd(base + high), 1);
  }
  static Vector3<Avx2Doubles> load_nodes(const double* base, const std::uint32_t* i) {
    const Pack a = pair(base, i[0], i[2]), b = pair(base, i[1], i[3]);
    const Pack c = pair(base + 2, i[0], i[2]), d = pair(base + 2, i[1], i[3]);
    return {_mm256_unpacklo_pd(a, b), _mm256_unpackhi_pd(a, b), _mm256_unpacklo_pd(c, d)};
  }

  /// x0 y0 z0 x1 … z3 as three packs.
  static void store_nodes(double* base, const Vector3<Avx2Doubles>& n) {
    const Pack xy_low = _mm256_unpacklo_pd(n.x, n.y);                // x0 y0 x2 y2
    const Pack yz_high = _mm256_unpackhi_pd(n.y, n.z);               // y1 z1 y3 z3
    const Pack zx = _mm256_shuffle_pd(n.z, n.x, 0b1010);             // z0 x1 z2 x3
    store(base, _mm256_permute2f128_pd(xy_low, zx, 0x20));           // x0 y0 z0 x1
    store(base + 4, _mm256_permute2f128_pd(yz_high, xy_low, 0x30));  // y1 z1 x2 y2
    store(base + 8, _mm256_permute2f128_pd(zx, yz_high, 0x31));      // z2 x3 y3 z3
  }
};

}  // namespace
}  // namespace palpate::deformation::kernel
