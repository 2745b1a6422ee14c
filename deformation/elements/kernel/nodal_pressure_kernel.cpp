#include "deformation/elements/kernel/nodal_pressure_kernel.h"

#include <algorithm>

namespace palpate::deformation {

using kernel::ElementPart;

NodalPressureKernel::NodalPressureKernel(LinearTetrahedra tetrahedra,
                                         const ElasticConstants& tissue, ChunkRunner* runner,
                                         InstructionSet set,
                                         const AverageNodalPressureSettings& settings)
    : KernelElements(std::move(tetrahedra), true, runner, set),
      law_(tissue.shear_modulus(), settings.stabilisation * tissue.shear_modulus()),
      nodal_modulus_(nodal_bulk_modulus(tissue, settings)),
      rest_volumes_(mesh().node_count, 0),
      kept_(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(mesh().node_count))),
      shares_(Eigen::VectorXd::Ones(static_cast<Eigen::Index>(mesh().node_count))) {
  for (std::size_t e = 0; e < mesh().size(); ++e) {
    for (const auto node : mesh().corners[e]) rest_volumes_[node] += mesh().volumes[e];
  }
}

void NodalPressureKernel::take_volumes(const std::vector<Vec3>& positions) {
  for_parts([&](const ElementPart& part) {
    load_positions(part, positions);
    functions().take_volumes(part, parts().tetrahedra(), arrays());
  });
}

/// κ' (J_a − 1), of the volumes last taken.
double NodalPressureKernel::pressure(std::size_t node) const {
  return nodal_modulus_ * (sum_of(arrays().node_volumes, node) / rest_volumes_[node] - 1);
}

void NodalPressureKernel::take_pressures_of_shape(const std::vector<Vec3>& positions,
                                                  Eigen::VectorXd& pressures) {
  take_volumes(positions);
  pressures.resize(kept_.size());
  for (Eigen::Index i = 0; i < pressures.size(); ++i) {
    pressures[i] = pressure(static_cast<std::size_t>(i));
  }
}

void NodalPressureKernel::go_on_from(const Eigen::VectorXd& kept, const Eigen::VectorXd& shares) {
  kept_ = kept;
  shares_ = shares;
}

void NodalPressureKernel::linearise(const std::vector<Vec3>& positions, double scale,
                                    std::span<const double> shift) {
  take_volumes(positions);
  const kernel::PressureTerms terms{law_.shear_modulus, law_.volume_modulus, scale};
  for_parts([&](const ElementPart& part) {
    for (std::size_t slot = part.first_slot; slot < part.first_slot + part.slot_count; ++slot) {
      const std::uint32_t node = parts().node(slot);
      arrays().positions[4 * slot + 3] = kept_[node] + shares_[node] * pressure(node);
      // Of 4 v_a: κ'/V_a (∂v_a)(∂v_a)ᵀ is κ'/(4 · 4 V_a) of it.
      set_weight(slot, static_cast<float>(scale * shares_[node] * nodal_modulus_ /
                                          (4 * rest_volumes_[node])));
    }
    functions().assemble_pressure(part, parts().tetrahedra(), arrays(), terms);
  });
  finish(shift);
}

double NodalPressureKernel::energy(const std::vector<Vec3>& positions) {
  take_volumes(positions);
  const kernel::PressureTerms terms{law_.shear_modulus, law_.volume_modulus, 0};
  double sum = sum_over_parts([&](const ElementPart& part) {
    return functions().pressure_energy(part, parts().tetrahedra(), arrays(), terms);
  });
  for (std::size_t i = 0; i < rest_volumes_.size() && nodal_modulus_ > 0; ++i) {
    const double p = pressure(i);
    sum += rest_volumes_[i] / 4 * p * p / (2 * nodal_modulus_);
  }
  return sum;
}

}  // namespace palpate::deformation
