#include "palpate/scene_check.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

#include "deformation/organ_messages.h"
#include "haptics/devices/placed_device.h"
#include "modules/core/units.h"
#include "modules/geometry/bounding_box.h"
#include "modules/geometry/organ_shape.h"
#include "modules/runtime/clock.h"
#include "modules/runtime/worker_team.h"
#include "modules/scene/assets.h"
#include "modules/scene/key_list.h"
#include "modules/scene/key_place.h"
#include "modules/scene/models.h"
#include "modules/scene/probe_shape.h"
#include "modules/scene/processes.h"
#include "palpate/session/in_process.h"
#include "palpate/session/timed_stage.h"

namespace palpate::launcher {
namespace {

/// A warning where a shell's inner springs are neither of the two fitted to finite elements
/// (docs/calibration.md): its forces are then a choice, not a prediction.
void doubt_springs(const scene::Organ& organ, std::vector<std::string>& doubts) {
  constexpr double kFittedSolid = 10;
  const double fitted = scene::Springs{}.inner_ratio, ratio = organ.springs.inner_ratio;
  if (scene::is_solid(organ.model) || ratio == fitted || ratio == kFittedSolid) return;
  doubts.push_back(fmt::format(
      "organ '{}': inner_ratio {:g} is not calibrated (fitted: {:g} for a filled shell, {:g} for a "
      "solid, docs/calibration.md)",
      organ.name, ratio, fitted, kFittedSolid));
}

void doubt_contacts(const scene::Scene& scene, std::vector<std::string>& doubts) {
  if (!scene.contacts.organs || scene.organs.size() > 1) return;
  doubts.push_back("contacts: organs: true changes nothing: there is one organ");
}

OrganCheck check_of(const scene::Organ& organ, const geometry::OrganShape& shape,
                    const deformation::DeformationWorld& world, std::size_t index, double period) {
  const SurfaceTopology& topology = deformation::surface_message(world, index);
  const auto box = geometry::bounding_box(shape.surface.nodes);
  std::array<std::size_t, 3> springs{};
  for (const auto& spring : topology.springs) ++springs[static_cast<std::size_t>(spring.family)];
  OrganCheck check;
  check.name = organ.name;
  check.model = organ.model;
  check.size = box.sizes();
  check.volume = geometry::enclosed_volume(shape.surface.nodes, shape.surface.triangles);
  check.mass = organ.tissue.density * check.volume;
  check.surface_nodes = topology.surface_node_count;
  check.inner_nodes = topology.rest_positions.size() / 3 - topology.surface_node_count;
  check.fixed_nodes = topology.fixed_nodes.size();
  check.triangles = topology.triangles.size();
  check.tetrahedra = shape.tetrahedra.size();
  check.quadratic = !shape.edge_nodes.empty();
  if (shape.is_solid()) {
    check.asked_poisson_ratio = organ.solid.poisson_ratio;
    check.computed_poisson_ratio = deformation::computed_poisson_ratio(organ);
  }
  check.structural = springs[0];
  check.bending = springs[1];
  check.inner = springs[2];
  if (scene::format_of(organ.model).has_integrator) check.integrator = world.integrator(index);
  check.integrator_automatic = organ.integrator == scene::Integrator::kAutomatic;
  check.largest_step = world.stable_step(index);
  check.substeps = world.substeps(index, period);
  return check;
}

/// As round as the scene's first probe [m]: a mesh that follows is as fine as that wants.
double tip_of(const scene::Scene& scene) {
  constexpr double kUsual = 5e-3;
  if (scene.probes.empty()) return kUsual;
  const auto form = scene::form_of(scene.probes[0].shape);
  const auto* core = std::get_if<geometry::RoundedSegment>(&form);
  return core != nullptr ? core->radius : kUsual;
}

/// The scene with a sphere for its probes, which is moved from outside.
scene::Scene touched_by_sphere(scene::Scene scene) {
  scene.probes = {{"tip", scene::SphereShape{tip_of(scene)}, 0.1, scene::ScriptedDevice{}}};
  return scene;
}

double wall_time() { return seconds_from_ns(runtime::monotonic_now_ns()); }
double thread_time() { return seconds_from_ns(runtime::thread_time_ns()); }

/// A session of the scene with its deformation timed.
class TimedSession {
 public:
  TimedSession(const scene::Scene& scene, std::vector<geometry::OrganShape> shapes,
               ChunkRunner& runner)
      : radius_(tip_of(scene)),
        is_alone_(scene.deformation_threads <= 1),
        follows_(!scene.organs.empty() && scene.organs[0].solid.refine.follow),
        session_(touched_by_sphere(scene), {std::move(shapes), {geometry::TriangleSurface{}}},
                 options(runner)) {
    auto device = std::make_unique<haptics::PlacedDevice>(Pose{});
    tip_ = device.get();
    session_.haptics().set_device(0, std::move(device));
    choose_place();
  }

  const deformation::DeformationWorld& world() const { return session_.world(); }
  ContactTroubles contact_troubles() const { return session_.contact_troubles(); }
  double mesh_changes() const { return changes_; }  ///< per second while that was measured

  /// Time of deformation in a period, mean over about `measure_for` seconds [s]. The sphere
  /// presses a triangle that is free to move once a second, 1 mm deep: an implicit step that has
  /// nothing to do is no measure of one that has. Over a mesh that follows it also goes to and fro
  /// by half its radius, so that the mesh changes as in a slide.
  double cost_of_period(double period, double measure_for) {
    place_tip();
    session_.run_until(period);  // memory is taken, caches are warm
    spent_ = 0;
    const std::uint32_t first = world().generation(0);
    const double end = wall_time() + measure_for;
    int periods = 0;
    for (; wall_time() < end; ++periods) {
      place_tip();
      session_.run_until(session_.time() + period);
    }
    changes_ = (world().generation(0) - first) / (periods * period);
    return periods > 0 ? spent_ / periods : 0;
  }

 private:
  session::InProcessOptions options(ChunkRunner& runner) {
    session::InProcessOptions options;
    options.runner = &runner;
    options.make = [this](std::string_view module, bus::Bus& bus,
                          const session::MakeStage& usual) -> std::unique_ptr<runtime::Stage> {
      if (module != "deformation") return usual(bus);
      // Alone it needs what its thread does, whoever else is busy on this machine: in a run it goes
      // before them. Where a team computes, who waits for it does nothing.
      return std::make_unique<session::TimedStage>(usual(bus), is_alone_ ? thread_time : wall_time,
                                                   spent_);
    };
    return options;
  }

  /// On the mesh as it begins: others have other triangles.
  void choose_place() {
    const deformation::OrganModel& organ = world().model(0);
    const std::set<std::uint32_t> fixed(organ.fixed_nodes.begin(), organ.fixed_nodes.end());
    const auto free = std::find_if(
        organ.triangles.begin(), organ.triangles.end(), [&](const geometry::Triangle& t) {
          return std::none_of(t.begin(), t.end(), [&](auto node) { return fixed.contains(node); });
        });
    if (free == organ.triangles.end()) return;
    const auto corner = [&](std::size_t k) { return organ.rest_positions[(*free)[k]]; };
    place_ = {(corner(0) + corner(1) + corner(2)) / 3,
              (corner(1) - corner(0)).cross(corner(2) - corner(0)).normalized()};
  }

  void place_tip() {
    if (!place_) return;
    const double phase = 2 * M_PI * session_.time();
    const double depth = 0.5e-3 * (1 - std::cos(phase));
    Pose pose;
    pose.position = place_->middle + (radius_ - depth) * place_->normal;
    if (follows_) {
      pose.position += radius_ / 2 * std::sin(phase) * place_->normal.unitOrthogonal();
    }
    tip_->place(pose);
  }

  struct Place {
    Vec3 middle, normal;
  };

  const double radius_;  ///< of the tip [m]
  const bool is_alone_, follows_;
  std::optional<Place> place_;  ///< none: all is fixed
  double changes_ = 0;
  double spent_ = 0;  ///< in deformation so far [s]
  session::InProcess session_;
  haptics::PlacedDevice* tip_ = nullptr;
};

}  // namespace

SceneCheck check_scene(const scene::Scene& scene, double measure_for,
                       const trajectories::Progress& progress,
                       const scene::Resampling& resampling) {
  SceneCheck check;
  check.scene = scene;
  check.period = 1 / scene.rates.deformation;
  std::vector<geometry::OrganShape> shapes;
  std::vector<geometry::TriangleSurface> skins;
  for (std::size_t i = 0; i < scene.organs.size(); ++i) {
    shapes.push_back(scene::with_organ(
        scene, i, [&](const auto& organ) { return scene::load_organ(organ, resampling); }));
    skins.push_back(shapes.back().surface);
  }
  SceneDoubts doubts = doubts_about(scene, skins, progress);
  check.doubts = std::move(doubts.lines);
  for (std::size_t i = 0; i < scene.probes.size(); ++i) {
    const scene::Probe& probe = scene.probes[i];
    check.probes.push_back({probe.name, scene::word_of_option(probe.shape),
                            scene::word_of_option(probe.device), doubts.motions[i]});
  }
  doubt_contacts(scene, check.doubts);
  runtime::WorkerTeam team(scene.deformation_threads);
  TimedSession session(scene::in_one_process(scene), shapes, team);
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    doubt_springs(scene.organs[i], check.doubts);
    check.organs.push_back(check_of(scene.organs[i], shapes[i], session.world(), i, check.period));
  }
  check.cost = session.cost_of_period(check.period, measure_for);
  check.mesh_changes = session.mesh_changes();
  check.troubles = session.contact_troubles();
  return check;
}

}  // namespace palpate::launcher
