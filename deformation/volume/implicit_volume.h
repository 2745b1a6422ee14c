// The rules of `implicit_volume`, whose constraint is derived in volume_constraint.h, and of
// `mass_spring`, which has none.
#pragma once

#include "deformation/model/organ_model.h"
#include "deformation/volume/volume_rule.h"

namespace palpate::deformation {

/// Of the bound; Gershgorin is on the safe side, the volume constraint takes a few per cent.
inline constexpr double kStepSafety = 0.9;

class ImplicitVolume : public VolumeRule {
 public:
  explicit ImplicitVolume(const OrganModel& model, int corrections = 0)
      : largest_step_(kStepSafety * stable_step_bound(model)), corrections_(corrections) {}
  double largest_step() const override { return largest_step_; }
  bool reads_gradient() const override { return true; }
  int corrections() const override { return corrections_; }
  VolumeAction before_contacts(double h, const OrganState& state, FreeStep& step) override {
    return {.rate = (step.volume.volume - state.target_volume) / h};
  }

 private:
  double largest_step_;
  int corrections_;
};

class NoVolume : public VolumeRule {
 public:
  explicit NoVolume(const OrganModel& model)
      : largest_step_(kStepSafety * stable_step_bound(model)) {}
  double largest_step() const override { return largest_step_; }
  VolumeAction before_contacts(double, const OrganState&, FreeStep&) override { return {}; }

 private:
  double largest_step_;
};

}  // namespace palpate::deformation
