// corotational.h, fast.
#pragma once

#include "deformation/elements/kernel/kernel_elements.h"
#include "deformation/materials/corotated_linear.h"

namespace palpate::deformation {

class CorotationalKernel : public KernelElements {
 public:
  /// @param tissue  ν < 1/2
  CorotationalKernel(LinearTetrahedra tetrahedra, const ElasticConstants& tissue,
                     ChunkRunner* runner = nullptr,
                     InstructionSet set = available_instruction_sets().back());

  void linearise(const std::vector<Vec3>& positions, double scale,
                 std::span<const double> shift) override;
  double energy(const std::vector<Vec3>& positions) override;

 private:
  CorotatedLinear law_;
};

}  // namespace palpate::deformation
