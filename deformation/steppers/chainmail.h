// 3D ChainMail: the organ as links that may shorten and stretch so far and no further. Kinematic.
//
// S. F. F. Gibson, "3D ChainMail: a fast algorithm for deforming volumetric objects", Symposium on
// Interactive 3D Graphics 1997: a moved element moves a neighbour only if the link between them
// would leave its bounds, and then just to the bound; that neighbour its neighbours in turn; an
// elastic relaxation then evens the shape out. Y. Li, K. Brodlie, "Soft object modelling with
// generalised ChainMail", Computer Graphics Forum 22, 2003: the same on meshes that are no grids.
//
// Here: links are the mesh edges and the inner springs to the axis, bounded by length,
// kShortest l₀ ≤ ‖x_b − x_a‖ ≤ kLongest l₀. One step:
//   1. relaxation, one Jacobi step to the springs' equilibrium: x_i += r F_i / Σ_j k_ij
//   2. contacts push their nodes out of the probe, no faster than kMaxSeparationSpeed (no friction)
//   3. the chain: from the pushed nodes outwards, first come first served, each node once
//   4. loops of the mesh that 3 left out of bounds: sweeps over all links, both ends sharing
// There is no mass, gravity, volume or time: each step relaxes by the same part, however long.
// There is no force either. What a contact reports is what the springs of its nodes would need to
// have moved as far as it pushed them: Σ_k b_k Σ_j k_kj · push/(r Σ b²). On a probe at rest that is
// the springs' force; on a moving one the push of its motion comes on top.
#pragma once

#include "deformation/model/organ_model.h"
#include "deformation/springs/kernel/spring_kernel.h"
#include "deformation/steppers/organ_dynamics.h"

namespace palpate::deformation {

class ChainMail : public OrganDynamics {
 public:
  static constexpr double kShortest = 0.65, kLongest = 1.25;  ///< of a link's rest length
  static constexpr double kRelaxation = 0.5;  ///< r; stable below 1, by Gershgorin's circles
  static constexpr double kStill = 1e-8;      ///< shorter moves of the relaxation are not made [m]
  static constexpr double kLargestStep = 1e-3;     ///< [s]; nothing becomes unstable
  static constexpr double kBoundTolerance = 1e-3;  ///< step 4 ends here, of a rest length …
  static constexpr int kMaxSweeps = 20;            ///< … or after so many

  explicit ChainMail(const OrganModel& model);
  double largest_step() const override { return kLargestStep; }
  StepReport step(double h, std::span<ContactRow> rows, OrganState& state) override;
  double elastic_energy(const OrganState& state) override {
    return kernel_.elastic_energy(state.positions);
  }

  struct Link {
    std::uint32_t node_a = 0, node_b = 0;
    double rest_length = 0;  ///< [m]
  };
  const std::vector<Link>& links() const { return links_; }

 private:
  void relax(OrganState& state);
  void push(double h, ContactRow& row, std::vector<Vec3>& positions);
  void spread(std::vector<Vec3>& positions);
  void sweep_links(std::vector<Vec3>& positions) const;

  const OrganModel& model_;
  std::vector<Link> links_;
  std::vector<std::vector<std::uint32_t>> links_of_;  ///< link indices per node
  // of one step
  SpringKernel kernel_;
  FreeStep free_;
  std::vector<Vec3> old_positions_;
  std::vector<std::uint32_t> queue_;
  std::vector<bool> held_, queued_, done_;
};

}  // namespace palpate::deformation
