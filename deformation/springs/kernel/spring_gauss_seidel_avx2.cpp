// Visits of springs for CPUs with AVX2 and FMA.
#include <immintrin.h>

#include "deformation/springs/kernel/spring_gauss_seidel_body.h"

namespace palpate::deformation::kernel {
namespace {

struct Avx2Visits {
  static constexpr std::size_t kWidth = 4;
  using Pack = __m256d;

  static Pack broadcast(double value) { return _mm256_set1_pd(value); }
  static Pack load(const double* from) { return _mm256_loadu_pd(from); }
  static void store(double* to, const Pack& pack) { _mm256_storeu_pd(to, pack); }
  static Pack root(const Pack& x) { return _mm256_sqrt_pd(x); }

  /// Rows to columns, and back.
  static VisitedNodes<Avx2Visits> transposed(const Pack& a, const Pack& b, const Pack& c,
                                             const Pack& d) {
    const Pack xz_ab = _mm256_unpacklo_pd(a, b), yw_ab = _mm256_unpackhi_pd(a, b);
    const Pack xz_cd = _mm256_unpacklo_pd(c, d), yw_cd = _mm256_unpackhi_pd(c, d);
    return {_mm256_permute2f128_pd(xz_ab, xz_cd, 0x20), _mm256_permute2f128_pd(yw_ab, yw_cd, 0x20),
            _mm256_permute2f128_pd(xz_ab, xz_cd, 0x31), _mm256_permute2f128_pd(yw_ab, yw_cd, 0x31)};
  }

  static VisitedNodes<Avx2Visits> load_nodes(const double* base, const std::uint32_t* i) {
    return transposed(load(base + i[0]), load(base + i[1]), load(base + i[2]), load(base + i[3]));
  }

  static void store_nodes(double* base, const std::uint32_t* i, const VisitedNodes<Avx2Visits>& n) {
    const auto rows = transposed(n.x, n.y, n.z, n.inverse_mass);
    store(base + i[0], rows.x);
    store(base + i[1], rows.y);
    store(base + i[2], rows.z);
    store(base + i[3], rows.inverse_mass);
  }
};

}  // namespace

VisitSprings avx2_visits() { return &Visitor<Avx2Visits>::run; }

}  // namespace palpate::deformation::kernel
