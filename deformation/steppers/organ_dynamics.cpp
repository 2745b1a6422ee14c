#include "deformation/steppers/organ_dynamics.h"

#include <cmath>

#include "deformation/elements/average_nodal_pressure.h"
#include "deformation/elements/corotational.h"
#include "deformation/steppers/backward_euler.h"
#include "deformation/steppers/chainmail.h"
#include "deformation/steppers/linearly_implicit_euler.h"
#include "deformation/steppers/modal.h"
#include "deformation/steppers/newton_backward_euler.h"
#include "deformation/steppers/symplectic_euler.h"
#include "deformation/steppers/xpbd_springs.h"
#include "deformation/steppers/xpbd_tetrahedra.h"
#include "deformation/volume/rules/baumgarte.h"
#include "deformation/volume/rules/bourguignon_cani.h"
#include "deformation/volume/rules/element_volume.h"
#include "deformation/volume/rules/penalty.h"
#include "deformation/volume/rules/post_stabilisation.h"
#include "deformation/volume/rules/promayon.h"
#include "deformation/volume/rules/zordan.h"
#include "modules/core/error.h"
#include "modules/scene/schema.h"

namespace palpate::deformation {
namespace {

/// Backward Euler damps and lags; it must save more than this factor.
constexpr double kWorthwhile = 2;

void check_integrator(const scene::Organ& organ) {
  if (!has_own_steps(organ.model) || organ.integrator != scene::Integrator::kBackwardEuler) return;
  throw InputError("organ '" + organ.name + "': model " + scene::word_of(organ.model) +
                   " has steps of its own; integrator must be automatic or symplectic_euler");
}

/// What a neighbour method asks of the scene beyond the implicit constraint.
void check_neighbour(const scene::Organ& organ, const OrganModel& model) {
  const bool pyramids =
      organ.model == scene::Model::kZordan || organ.model == scene::Model::kElementVolume;
  if (pyramids && model.node_count() == model.surface_node_count) {
    throw InputError("organ '" + organ.name + "': model " + scene::word_of(organ.model) +
                     " needs virtual nodes as apexes of its pyramids; springs: virtual_nodes must "
                     "be at least 1 and inner_ratio above 0");
  }
}

std::unique_ptr<OrganDynamics> make_neighbour(const scene::Organ& organ, const OrganModel& model) {
  check_neighbour(organ, model);
  switch (organ.model) {
    case scene::Model::kPenalty:
      return std::make_unique<Penalty>(model);
    case scene::Model::kBaumgarte:
      return std::make_unique<Baumgarte>(model);
    case scene::Model::kPromayon:
      return std::make_unique<Promayon>(model);
    case scene::Model::kPostStabilisation:
      return std::make_unique<PostStabilisation>(model);
    case scene::Model::kBourguignonCani:
      return std::make_unique<BourguignonCani>(model);
    case scene::Model::kZordan:
      return std::make_unique<Zordan>(model);
    case scene::Model::kElementVolume:
      return std::make_unique<ElementVolume>(model);
    default:
      PALPATE_DEMAND(organ.model == scene::Model::kChainMail);
      return std::make_unique<ChainMail>(model);
  }
}

}  // namespace

bool has_own_steps(scene::Model model) {
  return model != scene::Model::kImplicitVolume && model != scene::Model::kMassSpring;
}

IntegratorChoice choose_integrator(const scene::Organ& organ, const OrganModel& model,
                                   double period) {
  IntegratorChoice choice;
  if (has_own_steps(organ.model)) return choice;
  choice.symplectic_passes = std::ceil(period / SymplecticEuler::largest_step(model)) / period;
  choice.backward_passes = std::ceil(period / BackwardEuler::kLargestStep) / period *
                           BackwardEuler::passes(BackwardEuler::kIterations);
  if (organ.integrator != scene::Integrator::kAutomatic) {
    choice.integrator = organ.integrator;
  } else if (choice.symplectic_passes > kWorthwhile * choice.backward_passes) {
    choice.integrator = scene::Integrator::kBackwardEuler;
  }
  return choice;
}

std::unique_ptr<OrganDynamics> make_dynamics(const scene::Organ& organ, const OrganModel& model,
                                             double period, ChunkRunner* runner) {
  check_integrator(organ);
  const auto iterations = [&](int usual) {
    return organ.iterations > 0 ? static_cast<int>(organ.iterations) : usual;
  };
  switch (organ.model) {
    case scene::Model::kImplicitVolume:
    case scene::Model::kMassSpring:
      if (choose_integrator(organ, model, period).integrator == scene::Integrator::kBackwardEuler) {
        return std::make_unique<BackwardEuler>(model);
      }
      return std::make_unique<SymplecticEuler>(model, runner);
    case scene::Model::kCorotational:
      return std::make_unique<LinearlyImplicitEuler>(
          model,
          std::make_unique<Corotational>(
              LinearTetrahedra(model.rest_positions, model.mesh().tetrahedra),
              model.mesh().elastic()),
          iterations(Corotational::kIterations));
    case scene::Model::kNodalPressure:
      return std::make_unique<LinearlyImplicitEuler>(
          model,
          std::make_unique<AverageNodalPressure>(
              LinearTetrahedra(model.rest_positions, model.mesh().tetrahedra),
              model.mesh().elastic()),
          iterations(AverageNodalPressure::kIterations));
    case scene::Model::kXpbdSprings:
      return std::make_unique<XpbdSprings>(model, iterations(1));
    case scene::Model::kXpbdTetrahedra:
      return std::make_unique<XpbdTetrahedra>(model, model.mesh(), iterations(1));
    case scene::Model::kQuadraticElements:
      return std::make_unique<NewtonBackwardEuler>(model);
    case scene::Model::kModal:
      return std::make_unique<Modal>(model, organ.solid.modes, organ.tissue.damping_ratio);
    default:
      return make_neighbour(organ, model);
  }
}

}  // namespace palpate::deformation
