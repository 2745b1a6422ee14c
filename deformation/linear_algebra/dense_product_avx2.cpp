// The dense product for CPUs with AVX2 and FMA.
#include <immintrin.h>

#include "deformation/linear_algebra/dense_product_body.h"

namespace palpate::deformation::dense {
namespace {

struct Avx2Packs {
  using Pack = __m256d;
  static constexpr std::size_t kWidth = 4, kPacks = 3, kColumns = 4;

  static Pack load(const double* from) { return _mm256_loadu_pd(from); }
  static void store(double* to, const Pack& pack) { _mm256_storeu_pd(to, pack); }
  static Pack broadcast(double value) { return _mm256_set1_pd(value); }
  static Pack fma(const Pack& a, const Pack& b, const Pack& c) { return _mm256_fmadd_pd(a, b, c); }
};

}  // namespace

const Functions& avx2_functions() { return Product<Avx2Packs>::functions; }

}  // namespace palpate::deformation::dense
