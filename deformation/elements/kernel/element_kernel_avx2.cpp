// The element kernel for CPUs with AVX2 and FMA.
#include "deformation/elements/kernel/element_corotational_body.h"
#include "deformation/packs/avx2_packs.h"

namespace palpate::deformation::kernel {

const ElementFunctions& avx2_element_functions() {
  return kElementFunctions<Avx2Floats, Avx2Doubles>;
}

}  // namespace palpate::deformation::kernel
