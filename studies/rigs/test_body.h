// One organ that is stepped with any h: model, stepper and state, without a world.
#pragma once

#include <memory>

#include "deformation/model/organ_model.h"
#include "deformation/model/organ_state.h"
#include "deformation/steppers/organ_dynamics.h"
#include "modules/geometry/organ_shape.h"
#include "modules/scene/scene.h"

namespace palpate::rigs {

class TestBody {
 public:
  /// @param shape  its rest positions are in W
  /// @param period  of the world that is not there [s]: the stepper is chosen for it
  TestBody(const scene::Organ& organ, const geometry::OrganShape& shape, double period = 4e-3);

  const deformation::OrganModel& model() const { return *model_; }
  deformation::OrganDynamics& dynamics() { return *dynamics_; }
  deformation::OrganState& state() { return state_; }
  const deformation::OrganState& state() const { return state_; }
  double mass() const;  ///< [kg]

 private:
  std::unique_ptr<const deformation::OrganModel> model_;
  std::unique_ptr<deformation::OrganDynamics> dynamics_;
  deformation::OrganState state_;
};

}  // namespace palpate::rigs
