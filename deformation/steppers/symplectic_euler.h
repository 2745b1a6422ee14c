// One step of an organ by semi-implicit (symplectic) Euler, contacts and volume inside.
#pragma once

#include <span>
#include <vector>

#include "deformation/springs/kernel/spring_kernel.h"
#include "deformation/steppers/organ_dynamics.h"

namespace palpate::deformation {

/// Buffers kept between steps so that a step does not allocate.
struct StepBuffers {
  std::vector<Vec3> forces;
  VolumeGradient volume;
  std::vector<Vec3> velocities;
};

/// v̂ = v + h M⁻¹F of springs, damping, drag and gravity, into state.velocities; fixed nodes rest.
void apply_forces(const OrganModel& model, double h, OrganState& state, std::vector<Vec3>& forces);

/// Newton: solves the volume constraint anew at the step's end, linearised there, and moves the
/// end accordingly. The impulses of contacts and volume go on from what they are, so the pressure
/// is that of all of them together.
/// @param report  of the step so far; its impulse is added to
void correct_volume(const OrganModel& model, double h, std::span<ContactRow> rows,
                    OrganState& state, StepBuffers& buffers, ContactSolveReport& report);

/// Advances the state by h [s]. Stable for h below stable_step_bound(). Contact rows must hold
/// their gaps at the current positions. The plain code, without a limit of the pressure:
/// SymplecticEuler does the same faster.
ContactSolveReport symplectic_euler_step(const OrganModel& model, double h,
                                         std::span<ContactRow> rows, OrganState& state,
                                         StepBuffers& buffers);

class SymplecticEuler : public OrganDynamics {
 public:
  /// @param runner  outlives this; none: the calling thread alone
  explicit SymplecticEuler(const OrganModel& model, ChunkRunner* runner = nullptr);
  static double largest_step(const OrganModel& model);
  double largest_step() const override { return largest_step_; }
  StepReport step(double h, std::span<ContactRow> rows, OrganState& state) override;
  double elastic_energy(const OrganState& state) override {
    return kernel_.elastic_energy(state.positions);
  }

 private:
  void push_with(double volume_impulse, double h, std::span<ContactRow> rows, OrganState& state);
  void correct_volume(double h, std::span<ContactRow> rows, OrganState& state,
                      ContactSolveReport& report);

  const OrganModel& model_;
  double largest_step_;
  SpringKernel kernel_;
  FreeStep free_;
  std::vector<Vec3> start_;  ///< positions, for corrections
};

}  // namespace palpate::deformation
