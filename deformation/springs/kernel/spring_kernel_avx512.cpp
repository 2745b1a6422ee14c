// The spring kernel and product for CPUs with AVX-512 F, DQ and VL.
#include "deformation/packs/avx512_packs.h"
#include "deformation/springs/kernel/spring_hessian_product_body.h"
#include "deformation/springs/kernel/spring_kernel_body.h"

namespace palpate::deformation::kernel {

const Functions& avx512_functions() { return Kernel<Avx512Floats, Avx512Doubles>::functions; }

const ProductFunctions& avx512_product_functions() { return Product<Avx512Floats>::functions; }

}  // namespace palpate::deformation::kernel
