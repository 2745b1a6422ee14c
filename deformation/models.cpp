#include "deformation/models.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "deformation/elements/kernel/corotational_kernel.h"
#include "deformation/elements/kernel/nodal_pressure_kernel.h"
#include "deformation/elements/quadratic_pressure.h"
#include "deformation/steppers/backward_euler.h"
#include "deformation/steppers/chainmail.h"
#include "deformation/steppers/linearly_implicit_euler.h"
#include "deformation/steppers/modal.h"
#include "deformation/steppers/newton_backward_euler.h"
#include "deformation/steppers/symplectic_euler.h"
#include "deformation/steppers/xpbd_springs.h"
#include "deformation/steppers/xpbd_tetrahedra.h"
#include "deformation/volume/implicit_volume.h"
#include "deformation/volume/rules/baumgarte.h"
#include "deformation/volume/rules/bourguignon_cani.h"
#include "deformation/volume/rules/element_volume.h"
#include "deformation/volume/rules/penalty.h"
#include "deformation/volume/rules/post_stabilisation.h"
#include "deformation/volume/rules/promayon.h"
#include "deformation/volume/rules/zordan.h"
#include "modules/core/error.h"
#include "modules/scene/models.h"

namespace palpate::deformation {
namespace {

using Dynamics = std::unique_ptr<OrganDynamics>;

/// Backward Euler damps and lags; it must save more than this factor.
constexpr double kWorthwhile = 2;

template <class Rule>
Dynamics symplectic(const ModelParts& parts) {
  return std::make_unique<SymplecticEuler>(parts.model, std::make_unique<Rule>(parts.model));
}

/// Of a rule on pyramids, whose apex is a virtual node.
template <class Rule>
Dynamics on_pyramids(const ModelParts& parts) {
  if (parts.model.network().virtual_nodes.empty()) {
    throw InputError("organ '" + parts.organ.name + "': model " + parts.organ.model +
                     " needs virtual nodes as apexes of its pyramids; springs: virtual_nodes must "
                     "be at least 1 and inner_ratio above 0");
  }
  return symplectic<Rule>(parts);
}

Dynamics mass_spring(const ModelParts& parts) {
  if (parts.integrator == scene::Integrator::kBackwardEuler) {
    return std::make_unique<BackwardEuler>(parts.model, KeptVolume{.is_kept = false},
                                           BackwardEuler::kIterations, parts.runner);
  }
  return std::make_unique<SymplecticEuler>(parts.model, std::make_unique<NoVolume>(parts.model),
                                           parts.runner);
}

Dynamics implicit_volume(const ModelParts& parts) {
  const int corrections = static_cast<int>(parts.organ.volume_corrections);
  if (parts.integrator == scene::Integrator::kBackwardEuler) {
    return std::make_unique<BackwardEuler>(parts.model, KeptVolume{.corrections = corrections},
                                           BackwardEuler::kIterations, parts.runner);
  }
  return std::make_unique<SymplecticEuler>(
      parts.model, std::make_unique<ImplicitVolume>(parts.model, corrections), parts.runner);
}

template <class Elements>
Dynamics linearly_implicit(const ModelParts& parts) {
  const TetMesh& mesh = parts.model.mesh();
  auto elements = std::make_unique<Elements>(
      LinearTetrahedra(parts.model.rest_positions, mesh.tetrahedra), mesh.elastic(), parts.runner);
  return std::make_unique<LinearlyImplicitEuler>(parts.model, std::move(elements),
                                                 parts.iterations);
}

Dynamics quadratic_pressure(const ModelParts& parts) {
  auto elements =
      std::make_unique<QuadraticPressure>(parts.model.rest_positions, parts.model.mesh());
  return std::make_unique<LinearlyImplicitEuler>(parts.model, std::move(elements),
                                                 parts.iterations);
}

Dynamics xpbd_tetrahedra(const ModelParts& parts) {
  return std::make_unique<XpbdTetrahedra>(parts.model, parts.model.mesh(), parts.iterations);
}

Dynamics xpbd_springs(const ModelParts& parts) {
  return std::make_unique<XpbdSprings>(parts.model, parts.iterations);
}

template <class Stepper>
Dynamics plain(const ModelParts& parts) {
  return std::make_unique<Stepper>(parts.model);
}

Dynamics modal(const ModelParts& parts) {
  return std::make_unique<Modal>(parts.model, parts.organ.solid.modes,
                                 parts.organ.tissue.damping_ratio);
}

using enum VolumeKeeping;

constexpr std::array<ModelRow, 17> kRows{{
    {.word = "mass_spring",
     .stands_for_fluid = true,
     .stands_for_solid = true,
     .make = mass_spring},
    {.word = "implicit_volume",
     .volume = kExactly,
     .has_volume_constraint = true,
     .stands_for_fluid = true,
     .stands_for_solid = true,
     .make = implicit_volume},
    {.word = "penalty",
     .volume = kAbout,
     .knows_energy = false,
     .stands_for_fluid = true,
     .make = symplectic<Penalty>},
    {.word = "baumgarte", .volume = kAbout, .is_charted = false, .make = symplectic<Baumgarte>},
    {.word = "promayon",
     .volume = kExactly,
     .conserves_angular_momentum = false,
     .knows_energy = false,
     .make = symplectic<Promayon>},
    {.word = "post_stabilisation",
     .volume = kExactly,
     .conserves_angular_momentum = false,
     .is_charted = false,
     .make = symplectic<PostStabilisation>},
    {.word = "bourguignon_cani",
     .volume = kAbout,
     .knows_energy = false,
     .is_charted = false,
     .make = symplectic<BourguignonCani>},
    {.word = "zordan",
     .volume = kAbout,
     .knows_energy = false,
     .press_every = 1,
     .is_charted = false,
     .make = on_pyramids<Zordan>},
    {.word = "element_volume",
     .volume = kAbout,
     .knows_energy = false,
     .press_every = 1,
     .step_cost = 5,
     .make = on_pyramids<ElementVolume>},
    {.word = "chainmail",
     .conserves_momentum = false,
     .conserves_angular_momentum = false,
     .knows_energy = false,
     .press_every = 1,
     .is_charted = false,
     .make = plain<ChainMail>},
    {.word = "xpbd_springs",
     .volume = kExactly,
     .conserves_angular_momentum = false,
     .stands_for_fluid = true,
     .make = xpbd_springs},
    {.word = "xpbd_tetrahedra",
     .conserves_angular_momentum = false,
     .press_every = 4,
     .step_cost = 10,
     .stands_for_solid = true,
     .make = xpbd_tetrahedra},
    {.word = "corotational",
     .conserves_angular_momentum = false,
     .step_cost = 100,
     .stands_for_solid = true,
     .make = linearly_implicit<CorotationalKernel>},
    {.word = "nodal_pressure",
     .conserves_angular_momentum = false,
     .tells_mesh_error = true,
     .step_cost = 100,
     .largest_bulk_over_shear = AverageNodalPressureSettings{}.largest_bulk_modulus,
     .stands_for_solid = true,
     .make = linearly_implicit<NodalPressureKernel>},
    {.word = "quadratic_pressure",
     .conserves_angular_momentum = false,
     .tells_mesh_error = true,
     .step_cost = 100,
     .largest_bulk_over_shear = QuadraticPressure::kLargestBulkModulus,
     .stands_for_solid = true,
     .make = quadratic_pressure},
    {.word = "modal",
     .conserves_angular_momentum = false,
     .step_cost = 100,
     .stands_for_solid = true,
     .make = modal},
    {.word = "quadratic_elements",
     .conserves_angular_momentum = false,
     .tells_mesh_error = true,
     .press_every = 1,
     .step_cost = 3000,
     .make = plain<NewtonBackwardEuler>},
}};

}  // namespace

std::span<const ModelRow> model_rows() { return kRows; }

const ModelRow& row_of(std::string_view model) {
  const auto found = std::ranges::find(kRows, model, &ModelRow::word);
  PALPATE_DEMAND(found != kRows.end());
  return *found;
}

double computed_poisson_ratio(const scene::Organ& organ) {
  const ElasticConstants asked(organ.tissue.youngs_modulus, organ.solid.poisson_ratio);
  const double most = row_of(organ.model).largest_bulk_over_shear;
  if (asked.bulk_over_shear() <= most) return asked.poisson_ratio();
  return (3 * most - 2) / (2 * (3 * most + 1));
}

IntegratorChoice choose_integrator(const scene::Organ& organ, const OrganModel& model,
                                   double period) {
  IntegratorChoice choice;
  if (!scene::format_of(organ.model).has_integrator) return choice;
  choice.symplectic_passes = std::ceil(period / NoVolume(model).largest_step()) / period;
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
  const scene::ModelFormat& format = scene::format_of(organ.model);
  if (!format.has_integrator && organ.integrator == scene::Integrator::kBackwardEuler) {
    throw InputError("organ '" + organ.name + "': model " + organ.model +
                     " has steps of its own; integrator must be automatic or symplectic_euler");
  }
  const std::size_t iterations = organ.iterations > 0 ? organ.iterations : format.iterations;
  return row_of(organ.model)
      .make({organ, model, static_cast<int>(iterations),
             choose_integrator(organ, model, period).integrator, runner});
}

}  // namespace palpate::deformation
