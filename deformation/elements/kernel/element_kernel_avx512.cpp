// The element kernel for CPUs with AVX-512 F, DQ and VL.
#include "deformation/elements/kernel/element_corotational_body.h"
#include "deformation/packs/avx512_packs.h"

namespace palpate::deformation::kernel {

const ElementFunctions& avx512_element_functions() {
  return kElementFunctions<Avx512Floats, Avx512Doubles>;
}

}  // namespace palpate::deformation::kernel
