// The dense product for CPUs with AVX-512 F.
#include <immintrin.h>

#include "deformation/linear_algebra/dense_product_body.h"

namespace palpate::deformation::dense {
namespace {

struct Avx512Packs {
  using Pack = __m512d;
  static constexpr std::size_t kWidth = 8, kPacks = 3, kColumns = 8;

  static Pack load(const double* from) { return _mm512_loadu_pd(from); }
  static void store(double* to, const Pack& pack) { _mm512_storeu_pd(to, pack); }
  static Pack broadcast(double value) { return _mm512_set1_pd(value); }
  static Pack fma(const Pack& a, const Pack& b, const Pack& c) { return _mm512_fmadd_pd(a, b, c); }
};

}  // namespace

const Functions& avx512_functions() { return Product<Avx512Packs>::functions; }

}  // namespace palpate::deformation::dense
