// The spring kernel and product for any CPU: registers of 128 bits, as the baseline of both x86-64
// and AArch64 has them.
#include "deformation/packs/portable_packs.h"
#include "deformation/springs/kernel/spring_hessian_product_body.h"
#include "deformation/springs/kernel/spring_kernel_body.h"

namespace palpate::deformation::kernel {

const Functions& portable_functions() { return Kernel<PortableFloats, PortableDoubles>::functions; }

const ProductFunctions& portable_product_functions() { return Product<PortableFloats>::functions; }

}  // namespace palpate::deformation::kernel
