// The spring product for CPUs with AVX2 and FMA; those with AVX-512 run it, too.
#include <immintrin.h>

#include "deformation/spring_product_body.h"

namespace palpate::deformation::kernel {
namespace {

struct Avx2Float {
  static constexpr std::size_t kWidth = 8;
  using Pack = __m256;

  static Pack broadcast(float value) { return _mm256_set1_ps(value); }
  static Pack load(const float* from) { return _mm256_loadu_ps(from); }
  static void store(float* to, const Pack& pack) { _mm256_storeu_ps(to, pack); }
  static Pack fma(const Pack& a, const Pack& b, const Pack& c) { return _mm256_fmadd_ps(a, b, c); }
  static Pack fnma(const Pack& a, const Pack& b, const Pack& c) {
    return _mm256_fnmadd_ps(a, b, c);
  }
  static Pack root(const Pack& x) { return _mm256_sqrt_ps(x); }
  static Pack absolute(const Pack& x) { return _mm256_andnot_ps(_mm256_set1_ps(-0.0f), x); }
  static Pack keep_below(const Pack& values, const Pack& a, const Pack& b) {
    return _mm256_and_ps(values, _mm256_cmp_ps(a, b, _CMP_LT_OQ));
  }

  /// Two nodes, the second above the first.
  static Pack pair(const float* base, std::uint32_t low, std::uint32_t high) {
    return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(base + 4ul * low)),
                                _mm_loadu_ps(base + 4ul * high), 1);
  }

  static Vector3<Avx2Float> load_nodes(const float* base, const std::uint32_t* i) {
    const Pack a = pair(base, i[0], i[4]), b = pair(base, i[1], i[5]);
    const Pack c = pair(base, i[2], i[6]), d = pair(base, i[3], i[7]);
    const Pack xy_ab = _mm256_unpacklo_ps(a, b), xy_cd = _mm256_unpacklo_ps(c, d);
    const Pack z_ab = _mm256_unpackhi_ps(a, b), z_cd = _mm256_unpackhi_ps(c, d);
    return {_mm256_shuffle_ps(xy_ab, xy_cd, 0b01000100),
            _mm256_shuffle_ps(xy_ab, xy_cd, 0b11101110), _mm256_shuffle_ps(z_ab, z_cd, 0b01000100)};
  }

  static void store_nodes(float* base, const Vector3<Avx2Float>& n) {
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
};

}  // namespace

const ProductFunctions& avx2_product_functions() { return Product<Avx2Float>::functions; }

}  // namespace palpate::deformation::kernel
