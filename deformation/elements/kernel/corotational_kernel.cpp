#include "deformation/elements/kernel/corotational_kernel.h"

namespace palpate::deformation {

CorotationalKernel::CorotationalKernel(LinearTetrahedra tetrahedra, const ElasticConstants& tissue,
                                       ChunkRunner* runner, InstructionSet set)
    : KernelElements(std::move(tetrahedra), false, runner, set), law_(tissue) {}

void CorotationalKernel::linearise(const std::vector<Vec3>& positions, double scale,
                                   std::span<const double> shift) {
  const kernel::CorotationalTerms terms{law_.shear_modulus, law_.lambda, scale};
  for_parts([&](const kernel::ElementPart& part) {
    load_positions(part, positions);
    functions().assemble_corotational(part, parts().tetrahedra(), arrays(), terms);
  });
  finish(shift);
}

double CorotationalKernel::energy(const std::vector<Vec3>& positions) {
  const kernel::CorotationalTerms terms{law_.shear_modulus, law_.lambda, 0};
  return sum_over_parts([&](const kernel::ElementPart& part) {
    load_positions(part, positions);
    return functions().corotational_energy(part, parts().tetrahedra(), arrays(), terms);
  });
}

}  // namespace palpate::deformation
