#include "deformation/linear_algebra/dense_product.h"

#include "deformation/linear_algebra/dense_product_body.h"
#include "modules/core/error.h"

namespace palpate::deformation {
namespace {

const dense::Functions& dense_functions_of(InstructionSet set) {
#if defined(__x86_64__)
  if (set == InstructionSet::kAvx2) return dense::avx2_functions();
  if (set == InstructionSet::kAvx512) return dense::avx512_functions();
#endif
  PALPATE_DEMAND(set == InstructionSet::kPortable);
  return dense::portable_functions();
}

void subtract(InstructionSet set, const DenseProduct::ConstBlock& a,
              const DenseProduct::ConstBlock& b, DenseProduct::Block c, bool lower,
              std::vector<double>& scratch) {
  PALPATE_DEMAND(a.rows() == c.rows() && b.rows() == c.cols() && a.cols() == b.cols());
  const auto size = [](Eigen::Index count) { return static_cast<std::size_t>(count); };
  const dense::Operands operands{a.data(),
                                 b.data(),
                                 c.data(),
                                 size(a.outerStride()),
                                 size(b.outerStride()),
                                 size(c.outerStride()),
                                 size(c.rows()),
                                 size(c.cols()),
                                 size(a.cols()),
                                 lower};
  const dense::Functions& functions = dense_functions_of(set);
  const std::size_t wanted = functions.scratch_size(operands);
  if (scratch.size() < wanted) scratch.resize(wanted);
  functions.subtract(operands, scratch.data());
}

}  // namespace

DenseProduct::DenseProduct() : DenseProduct(available_instruction_sets().back()) {}

DenseProduct::DenseProduct(InstructionSet set) : set_(set) {}

void DenseProduct::subtract(const ConstBlock& a, const ConstBlock& b, Block c) {
  deformation::subtract(set_, a, b, c, false, strips_);
}

void DenseProduct::subtract_lower(const ConstBlock& a, const ConstBlock& b, Block c) {
  PALPATE_DEMAND(c.rows() >= c.cols());
  deformation::subtract(set_, a, b, c, true, strips_);
}

}  // namespace palpate::deformation
