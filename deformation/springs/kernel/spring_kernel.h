// The forces of all springs and the volume constraint's gradient in one pass over the nodes, fast.
//
// The plain code is spring_forces.h and volume_gradient.h. Each node gathers its springs from its
// neighbours in float, sixteen nodes side by side (spring_kernel_arrays.h): forces agree with the
// plain ones to some 1e-7 of stiffness times position, both ends of a spring to the bit. The volume
// gradient needs but a cross product more per neighbour in the one-ring, with d_j = x_j − x_i
//   g_i = ∂V/∂x_i = (1/6) Σ_ring d_j × d_j+1
// and is as exact as the forces. State, V itself and all sums are double.
// Any number of threads gives the same bits, and so do AVX2 and AVX-512. The portable code, for
// CPUs that do not fuse multiply and add, rounds its products and differs in the last digits.
// docs/decisions/0005-spring-kernel.md says why it looks as it does.
#pragma once

#include <vector>

#include "deformation/model/free_step.h"
#include "deformation/model/organ_state.h"
#include "deformation/packs/instruction_set.h"
#include "deformation/springs/kernel/spring_kernel_layout.h"
#include "modules/core/aligned_vector.h"
#include "modules/core/parallel.h"

namespace palpate::deformation {

class SpringKernel {
 public:
  /// @param body         outlives the kernel
  /// @param with_volume  whether V and its gradient are wanted, which cost a little
  /// @param runner       outlives the kernel; none: the calling thread alone
  SpringKernel(const Body& body, const SpringNetwork& network, bool with_volume,
               ChunkRunner* runner = nullptr,
               InstructionSet set = available_instruction_sets().back());

  /// The step of h [s] without the volume's multiplier, and what the multiplier needs. Allocates
  /// at the first call only.
  void free_step(double h, const OrganState& state, FreeStep& out);

  /// Of such a step the volume alone: V, g and gᵀM⁻¹g at other positions, and g·v̂ with the v̂ in
  /// `out`  (node_count), all in double. Zeros unless with_volume.
  void evaluate_volume(const std::vector<Vec3>& positions, FreeStep& out);

  /// The same where no step was made yet, too. @returns them, of `out`
  const VolumeGradient& volume_at(const std::vector<Vec3>& positions, FreeStep& out) {
    out.velocities.resize(positions.size(), Vec3::Zero());
    evaluate_volume(positions, out);
    return out.volume;
  }

  /// v⁺ = v̂ − M⁻¹g σ and x⁺ = x + h v⁺, taking v̂ out of `step`.
  /// @param volume_impulse  σ [Pa·s]
  void finish_step(double h, double volume_impulse, FreeStep& step, OrganState& state);

  double elastic_energy(const std::vector<Vec3>& positions);  ///< Σ ½k(l−l₀)² [J]

 private:
  void run(std::size_t count, ChunkBody body);
  void pack(const std::vector<Vec3>& positions, const std::vector<Vec3>* velocities);
  const double* readable_beyond(const std::vector<Vec3>& positions);
  kernel::Step make_step(double h, const std::vector<Vec3>& positions,
                         const std::vector<Vec3>& velocities, FreeStep& out);
  void sum_chunks(FreeStep& out) const;
  void finish_virtual_nodes(double h, const OrganState& state, FreeStep& out) const;

  const Body& body_;
  bool with_volume_;
  ChunkRunner* runner_;
  const kernel::Functions& functions_;
  SpringKernelLayout layout_;
  AlignedVector<float> nodes_;          ///< packed
  std::vector<Vec3> padded_positions_;  ///< of an organ without virtual nodes, and one more
  AlignedVector<float> virtual_forces_;
  std::vector<kernel::ChunkSums> sums_;
};

}  // namespace palpate::deformation
