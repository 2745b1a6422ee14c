// The element kernel for any CPU.
#include "deformation/elements/kernel/element_corotational_body.h"
#include "deformation/packs/portable_packs.h"

namespace palpate::deformation::kernel {

const ElementFunctions& portable_element_functions() {
  return kElementFunctions<PortableFloats, PortableDoubles>;
}

}  // namespace palpate::deformation::kernel
