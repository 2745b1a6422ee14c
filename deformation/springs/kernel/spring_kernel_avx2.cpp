// The spring kernel and product for CPUs with AVX2 and FMA.
#include "deformation/packs/avx2_packs.h"
#include "deformation/springs/kernel/spring_hessian_product_body.h"
#include "deformation/springs/kernel/spring_kernel_body.h"

namespace palpate::deformation::kernel {

const Functions& avx2_functions() { return Kernel<Avx2Floats, Avx2Doubles>::functions; }

const ProductFunctions& avx2_product_functions() { return Product<Avx2Floats>::functions; }

}  // namespace palpate::deformation::kernel
