// The spring kernel for CPUs with AVX-512 F, DQ and VL.
#include <immintrin.h>

#include "deformation/spring_kernel_body.h"

namespace palpate::deformation::kernel {
namespace {

struct Avx512 {
  static constexpr std::size_t kWidth = 8;
  using Pack = __m512d;

  static Pack broadcast(double value) { return _mm512_set1_pd(value); }
  static Pack load(const double* from) { return _mm512_loadu_pd(from); }
  static void store(double* to, const Pack& pack) { _mm512_storeu_pd(to, pack); }

  static Pack fma(const Pack& a, const Pack& b, const Pack& c) { return _mm512_fmadd_pd(a, b, c); }
  static Pack fnma(const Pack& a, const Pack& b, const Pack& c) {
    return _mm512_fnmadd_pd(a, b, c);
  }

  // GCC 12 takes the undefined register of the plain intrinsics for an uninitialised variable;
  // those with a mask, all ones here, and the compiler's own shuffle have none.

  /// Two nodes of four doubles, the second above the first.
  static Pack pair(const double* base, std::uint32_t low, std::uint32_t high) {
    const Pack half = _mm512_castpd256_pd512(_mm256_loadu_pd(base + low));
    return _mm512_maskz_insertf64x4(0xff, half, _mm256_loadu_pd(base + high), 1);
  }

  static Vector3<Avx512> load_nodes(const double* base, const std::uint32_t* i) {
    const Pack a = pair(base, i[0], i[2]), b = pair(base, i[1], i[3]);
    const Pack c = pair(base, i[4], i[6]), d = pair(base, i[5], i[7]);
    const Pack xz_low = __builtin_shufflevector(a, b, 0, 8, 2, 10, 4, 12, 6, 14);
    const Pack xz_high = __builtin_shufflevector(c, d, 0, 8, 2, 10, 4, 12, 6, 14);
    const Pack y_low = __builtin_shufflevector(a, b, 1, 9, 3, 11, 5, 13, 7, 15);
    const Pack y_high = __builtin_shufflevector(c, d, 1, 9, 3, 11, 5, 13, 7, 15);
    return {__builtin_shufflevector(xz_low, xz_high, 0, 1, 4, 5, 8, 9, 12, 13),
            __builtin_shufflevector(y_low, y_high, 0, 1, 4, 5, 8, 9, 12, 13),
            __builtin_shufflevector(xz_low, xz_high, 2, 3, 6, 7, 10, 11, 14, 15)};
  }

  /// x0 y0 z0 x1 … z7 as three packs.
  static void store_nodes(double* base, const Vector3<Avx512>& n) {
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

  static Pack inverse_root_guess(const Pack& x) {
    const __m256 root = _mm256_sqrt_ps(_mm512_maskz_cvtpd_ps(0xff, x));
    return _mm512_maskz_cvtps_pd(0xff, _mm256_div_ps(_mm256_set1_ps(1), root));
  }

  static Pack keep_below(const Pack& values, const Pack& a, const Pack& b) {
    return _mm512_maskz_mov_pd(_mm512_cmp_pd_mask(a, b, _CMP_LT_OQ), values);
  }
};

}  // namespace

const Functions& avx512_functions() { return Kernel<Avx512>::functions; }

}  // namespace palpate::deformation::kernel
