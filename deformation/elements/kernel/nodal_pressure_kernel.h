// average_nodal_pressure.h, fast.
#pragma once

#include "deformation/elements/average_nodal_pressure.h"
#include "deformation/elements/kernel/kernel_elements.h"

namespace palpate::deformation {

class NodalPressureKernel : public KernelElements {
 public:
  NodalPressureKernel(LinearTetrahedra tetrahedra, const ElasticConstants& tissue,
                      ChunkRunner* runner = nullptr,
                      InstructionSet set = available_instruction_sets().back(),
                      const AverageNodalPressureSettings& settings = {});

  void linearise(const std::vector<Vec3>& positions, double scale,
                 std::span<const double> shift) override;
  ElementPressures pressures() const override {
    return {rest_volumes_.size(), nodal_modulus_, law_.shear_modulus};
  }
  void take_pressures_of_shape(const std::vector<Vec3>& positions,
                               Eigen::VectorXd& pressures) override;
  void go_on_from(const Eigen::VectorXd& kept, const Eigen::VectorXd& shares) override;
  double energy(const std::vector<Vec3>& positions) override;

 private:
  void take_volumes(const std::vector<Vec3>& positions);
  double pressure(std::size_t node) const;

  StableNeoHookean law_;              ///< of each tetrahedron: μ, α
  double nodal_modulus_ = 0;          ///< κ' [Pa]
  std::vector<double> rest_volumes_;  ///< 4 V_a [m³]
  Eigen::VectorXd kept_;              ///< of the pressures of steps before [Pa]
  Eigen::VectorXd shares_;            ///< s of each node
};

}  // namespace palpate::deformation
