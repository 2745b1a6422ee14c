// The spring kernel for CPUs with AVX2.
#include <immintrin.h>

#include "deformation/spring_kernel_body.h"

namespace palpate::deformation::kernel {
namespace {

struct Avx2 {
  static constexpr std::size_t kWidth = 4;
  using Pack = __m256d;

  static Pack broadcast(double value) { return _mm256_set1_pd(value); }
  static Pack load(const double* from) { return _mm256_loadu_pd(from); }
  static void store(double* to, const Pack& pack) { _mm256_storeu_pd(to, pack); }

  static Pack fma(const Pack& a, const Pack& b, const Pack& c) { return _mm256_fmadd_pd(a, b, c); }
  static Pack fnma(const Pack& a, const Pack& b, const Pack& c) {
    return _mm256_fnmadd_pd(a, b, c);
  }

  /// Two doubles of two nodes, the second node's above the first's.
  static Pack pair(const double* base, std::uint32_t low, std::uint32_t high) {
    const Pack half = _mm256_castpd128_pd256(_mm_loadu_pd(base + low));
    return _mm256_insertf128_pd(half, _mm_loadu_pd(base + high), 1);
  }

  static Vector3<Avx2> load_nodes(const double* base, const std::uint32_t* i) {
    const Pack a = pair(base, i[0], i[2]), b = pair(base, i[1], i[3]);
    const Pack c = pair(base + 2, i[0], i[2]), d = pair(base + 2, i[1], i[3]);
    return {_mm256_unpacklo_pd(a, b), _mm256_unpackhi_pd(a, b), _mm256_unpacklo_pd(c, d)};
  }

  /// x0 y0 z0 x1 … z3 as three packs.
  static void store_nodes(double* base, const Vector3<Avx2>& n) {
    const Pack xy_low = _mm256_unpacklo_pd(n.x, n.y);                // x0 y0 x2 y2
    const Pack yz_high = _mm256_unpackhi_pd(n.y, n.z);               // y1 z1 y3 z3
    const Pack zx = _mm256_shuffle_pd(n.z, n.x, 0b1010);             // z0 x1 z2 x3
    store(base, _mm256_permute2f128_pd(xy_low, zx, 0x20));           // x0 y0 z0 x1
    store(base + 4, _mm256_permute2f128_pd(yz_high, xy_low, 0x30));  // y1 z1 x2 y2
    store(base + 8, _mm256_permute2f128_pd(zx, yz_high, 0x31));      // z2 x3 y3 z3
  }

  static Pack inverse_root_guess(const Pack& x) {
    const __m128 root = _mm_sqrt_ps(_mm256_cvtpd_ps(x));
    return _mm256_cvtps_pd(_mm_div_ps(_mm_set1_ps(1), root));
  }

  static Pack keep_below(const Pack& values, const Pack& a, const Pack& b) {
    return _mm256_and_pd(values, _mm256_cmp_pd(a, b, _CMP_LT_OQ));
  }
};

}  // namespace

const Functions& avx2_functions() { return Kernel<Avx2>::functions; }

}  // namespace palpate::deformation::kernel
