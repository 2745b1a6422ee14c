// The dense product for any CPU: multiplications and additions, two numbers at a time.
#include <cstring>

#include "deformation/linear_algebra/dense_product_body.h"

namespace palpate::deformation::dense {
namespace {

struct PortablePacks {
  using Pack = double __attribute__((vector_size(16)));
  static constexpr std::size_t kWidth = 2, kPacks = 2, kColumns = 4;

  static Pack load(const double* from) {
    Pack pack;
    std::memcpy(&pack, from, sizeof pack);
    return pack;
  }
  static void store(double* to, const Pack& pack) { std::memcpy(to, &pack, sizeof pack); }
  static Pack broadcast(double value) { return Pack{value, value}; }
  static Pack fma(const Pack& a, const Pack& b, const Pack& c) { return a * b + c; }
};

}  // namespace

const Functions& portable_functions() { return Product<PortablePacks>::functions; }

}  // namespace palpate::deformation::dense
