#include "deformation/world_organ.h"

#include <sstream>
#include <utility>

#include "deformation/contact/outer_seat.h"
#include "deformation/elements/quadratic_mesh_change.h"
#include "deformation/model/mesh_change.h"
#include "modules/core/error.h"
#include "modules/core/ranges.h"
#include "modules/core/vector_checks.h"
#include "modules/scene/models.h"

namespace palpate::deformation {
namespace {

constexpr double kLeastStep = 1e-6;  // [s]
/// Of the mean edge. Under a hand of 40 mm/s tissue goes about so far in 10 ms.
constexpr double kFarOfEdge = 0.05;

/// The organ as it is stepped: contacts with organs take symplectic Euler alone.
scene::Organ stepped_organ(const scene::Scene& scene, std::size_t index) {
  scene::Organ organ = scene.organs[index];
  const bool is_free = organ.integrator == scene::Integrator::kAutomatic;
  if (scene.contacts.any() && is_free && scene::format_of(organ.model).has_integrator) {
    organ.integrator = scene::Integrator::kSymplecticEuler;
  }
  return organ;
}

}  // namespace

Eigen::MatrixXd WorldOrgan::contact_compliance(std::span<const ComplianceRow> touched,
                                               double period) {
  const PeriodSteps steps{period, simulated.substeps(period), simulated.dynamics().is_implicit()};
  const StepMatrix last = simulated.dynamics().step_matrix();
  if (last && !copy && is_stale(last, touched)) simulated.dynamics().foresee(simulated.state());
  Eigen::MatrixXd own = simulated.dynamics().compliance(touched, steps);
  if (own.size() > 0) return own;
  const bool moved = look_ahead(period * steps.displaced());
  std::span<const Vec3> gradient;
  if (keeps_volume) {
    if (moved) take_volume_ahead();
    gradient = volume.gradient;
  }
  return compliance->solve(
      positions_ahead, touched, steps, gradient,
      [&](const Patch& patch, Eigen::MatrixXf& stiffness, Eigen::MatrixXf& damping) {
        if (springs) {
          springs->add(positions_ahead, patch, stiffness, damping);
        } else {
          simulated.dynamics().add_stiffness(patch, stiffness);
        }
      },
      simulated.dynamics().step_matrix());
}

/// Whether the matrix of the last step is of touched tissue that will be elsewhere in the next.
bool WorldOrgan::is_stale(const StepMatrix& last, std::span<const ComplianceRow> touched) const {
  const OrganState& state = simulated.state();
  const auto has_gone = [&](std::uint32_t node) {
    const Vec3 ahead = state.positions[node] + last.step * state.velocities[node];
    return is_longer_than(ahead - last.positions[node], kFarOfEdge * mean_edge);
  };
  return std::ranges::any_of(touched, [&](const ComplianceRow& row) {
    return std::ranges::any_of(row.weights, [&](const auto& at) { return has_gone(at.first); });
  });
}

/// Where nodes are that nothing stops. That is where an implicit step takes its forces, and
/// explicit ones in the mean over a period: a thin wall under a probe that comes is stiffer there.
/// @returns false if they are where they were at the last look, which another probe's law took
bool WorldOrgan::look_ahead(double time) {
  const OrganState& state = simulated.state();
  const bool is_first = positions_ahead.size() != state.positions.size();
  positions_ahead.resize(state.positions.size(), Vec3::Zero());
  const auto moved =
      Ranges(runner).sums(positions_ahead.size(), [&](std::size_t first, std::size_t last) {
        double count = 0;
        for (std::size_t i = first; i < last; ++i) {
          const Vec3 ahead = state.positions[i] + time * state.velocities[i];
          if (ahead != positions_ahead[i]) ++count;
          positions_ahead[i] = ahead;
        }
        return Ranges::Sums{count, 0};
      });
  return is_first || moved[0] > 0;
}

void WorldOrgan::take_volume_ahead() {
  const VolumeGradient* const found = simulated.dynamics().volume_at(positions_ahead);
  if (found != nullptr) {
    volume = *found;
  } else {
    evaluate_volume(simulated.model(), positions_ahead, volume);
  }
}

/// What is kept of the model beside it.
void WorldOrgan::know_model() {
  const OrganModel& model = simulated.model();
  positions_ahead.clear();
  surface = std::make_unique<SurfaceWalk>(model);
  mean_edge = geometry::mean_edge_length(
      {{model.rest_positions.begin(),
        model.rest_positions.begin() + static_cast<std::ptrdiff_t>(model.surface_node_count)},
       model.triangles});
}

void WorldOrgan::take(OrganMesh mesh, std::span<const CoreLine> outside) {
  const OrganModel &before = simulated.model(), &next = *mesh.model;
  RefinedShape& refined = mesh.refined;
  const auto seat = [&](OrganState& state) { seat_outside(outside, next, state.positions); };
  const auto goes_on = [&](const auto& change) {
    mesh.compliance->begin_with(
        *compliance, [&](const std::vector<Vec4f>& found) { return change.carried(found); });
    simulated.change_mesh(
        std::move(mesh.model), std::move(mesh.dynamics),
        [&](const OrganState& state) { return change.carried(state); }, seat);
  };
  if (next.mesh().edge_nodes.empty()) {
    goes_on(MeshChange(before, parents, next, refined.parents));
  } else {
    goes_on(QuadraticMeshChange(before, halvings, next, refined.halvings));
  }
  compliance = std::move(mesh.compliance);
  parents = std::move(refined.parents);
  halvings = std::move(refined.halvings);
  is_coarser = mesh.refined.is_coarser;
  generation = mesh.generation;
  know_model();
}

void WorldOrgan::change_mesh(std::span<const CoreLine> outside) {
  take(following->take_next(generation, simulated.model()), outside);
}

void WorldOrgan::exchange(StateArchive& archive) {
  archive(generation);
  if (following) {
    following->exchange(archive, generation);
    if (archive.reads()) take(following->present(generation), {});
  }
  archive(simulated, replaced, *compliance);
  if (copy) archive(*copy);
}

void WorldOrgan::reset() {
  generation += following != nullptr && following->next() != nullptr ? 2 : 1;
  if (following) take(following->begin(generation), {});
  simulated.reset();
  compliance->forget();
  if (copy) copy->forget();
}

WorldOrgan make_organ(const scene::Scene& scene, std::size_t index,
                      const geometry::OrganShape& shape, ChunkRunner* runner, Guarding guarding) {
  const scene::Organ organ = stepped_organ(scene, index);
  const double period = 1 / scene.rates.deformation;
  std::unique_ptr<FollowingOrgan> following;
  RefinedShape refined;
  OrganModel built = build_organ_model(organ, scene.gravity, shape);
  if (organ.solid.refine.follow) {
    following = std::make_unique<FollowingOrgan>(scene, organ, shape, runner);
    refined = following->begin(1).refined;
    hold_as_coarse(refined, built);
  }
  auto model = std::make_unique<const OrganModel>(std::move(built));
  auto dynamics = make_dynamics(organ, *model, period, runner);
  if (dynamics->largest_step() < kLeastStep) {
    std::ostringstream message;
    message << "organ '" << organ.name << "': its largest stable step is "
            << dynamics->largest_step() << " s, less than " << kLeastStep
            << " s; soften the tissue or even out the mesh ('nodes')";
    throw InputError(message.str());
  }
  const IntegratorChoice integrator = choose_integrator(organ, *model, period);
  WorldOrgan made{
      .name = organ.name,
      .simulated = SimulatedOrgan(organ, std::move(model), std::move(dynamics), guarding, runner),
      .integrator = integrator,
      .runner = runner,
  };
  const OrganModel& kept = made.simulated.model();
  const ModelRow& row = row_of(organ.model);
  made.keeps_volume = !kept.is_solid() && row.volume == VolumeKeeping::kExactly;
  made.tells_mesh_error = row.tells_mesh_error;
  if (!kept.is_solid()) {
    made.springs = std::make_unique<PatchSprings>(kept.network(), kept.node_count());
  }
  if (row.press_every > 0) made.copy = std::make_unique<PressedCopy>(row.press_every);
  made.following = std::move(following);
  made.parents = std::move(refined.parents);
  made.halvings = std::move(refined.halvings);
  made.compliance = make_compliance(kept, runner);
  made.know_model();
  return made;
}

}  // namespace palpate::deformation
