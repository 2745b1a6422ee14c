// Semi-implicit (symplectic) Euler of an organ of springs, contacts inside. How the volume acts is
// a rule of its own (volume_rule.h).
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "deformation/model/organ_model.h"
#include "deformation/springs/kernel/spring_kernel.h"
#include "deformation/steppers/organ_dynamics.h"
#include "deformation/volume/volume_rule.h"

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
/// their gaps at the current positions. The plain code of the implicit constraint, without a limit
/// of the pressure: SymplecticEuler does the same faster.
ContactSolveReport symplectic_euler_step(const OrganModel& model, double h,
                                         std::span<ContactRow> rows, OrganState& state,
                                         StepBuffers& buffers, const KeptVolume& volume = {});

class SymplecticEuler : public OrganDynamics {
 public:
  /// @param model   of springs, outlives this
  /// @param runner  outlives this; none: the calling thread alone
  SymplecticEuler(const OrganModel& model, std::unique_ptr<VolumeRule> rule,
                  ChunkRunner* runner = nullptr);
  double largest_step() const override { return rule_->largest_step(); }
  StepReport step(double h, std::span<ContactRow> rows, OrganState& state) override;
  bool is_implicit() const override { return false; }
  double elastic_energy(const OrganState& state) override {
    return kernel_.elastic_energy(state.positions);
  }
  double stored_energy(const OrganState& state) const override {
    return rule_->stored_energy(state);
  }
  const VolumeGradient* volume_at(const std::vector<Vec3>& positions) override {
    return rule_->reads_gradient() ? &kernel_.volume_at(positions, free_) : nullptr;
  }

 private:
  void push_with(double volume_impulse, double h, std::span<ContactRow> rows, OrganState& state);
  void correct_volume(double h, std::span<ContactRow> rows, OrganState& state,
                      ContactSolveReport& report);

  const OrganModel& model_;
  std::unique_ptr<VolumeRule> rule_;
  SpringKernel kernel_;
  // Of one step:
  FreeStep free_;
  std::vector<Vec3> start_;  ///< positions, for corrections
};

}  // namespace palpate::deformation
