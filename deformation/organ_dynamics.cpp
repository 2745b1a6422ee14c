#include "deformation/organ_dynamics.h"

#include "deformation/symplectic_euler.h"
#include "modules/core/error.h"

namespace palpate::deformation {

std::unique_ptr<OrganDynamics> make_dynamics(const scene::Organ& organ, const OrganModel& model) {
  switch (organ.model) {
    case scene::Model::kImplicitVolume:
    case scene::Model::kMassSpring:
      return std::make_unique<SymplecticEuler>(model);
    default:
      throw InputError("organ '" + organ.name + "': this model is not available yet");
  }
}

}  // namespace palpate::deformation
