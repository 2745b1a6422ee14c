#include "palpate/check_command.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <ostream>
#include <set>

#include "deformation/organ_messages.h"
#include "haptics/devices/placed_device.h"
#include "modules/core/error.h"
#include "modules/core/units.h"
#include "modules/geometry/organ_shape.h"
#include "modules/runtime/clock.h"
#include "modules/runtime/worker_team.h"
#include "modules/scene/assets.h"
#include "modules/scene/models.h"
#include "modules/scene/scene_reader.h"
#include "modules/scene/schema.h"
#include "palpate/session/contact_line.h"
#include "palpate/session/in_process.h"
#include "palpate/session/timed_stage.h"

namespace palpate::launcher {
namespace {

/// Which integrator, who chose it, and by what.
std::string integrator_text(const scene::Organ& organ,
                            const deformation::IntegratorChoice& choice) {
  const bool automatic = organ.integrator == scene::Integrator::kAutomatic;
  return fmt::format(
      "  integrator {} ({}): passes over the springs per simulated second: symplectic_euler "
      "{:.0f}, backward_euler {:.0f}\n",
      scene::word_of(choice.integrator), automatic ? "automatic" : "by the scene",
      choice.symplectic_passes, choice.backward_passes);
}

/// A warning where a shell's inner springs are neither of the two fitted to finite elements
/// (docs/calibration.md): its forces are then a choice, not a prediction.
std::string calibration_text(const scene::Organ& organ) {
  constexpr double kFittedSolid = 10;
  const double fitted = scene::Springs{}.inner_ratio, ratio = organ.springs.inner_ratio;
  if (ratio == fitted || ratio == kFittedSolid) return "";
  return fmt::format(
      "  warning: inner_ratio {:g} is not calibrated (fitted: {:g} for a filled shell, {:g} for a "
      "solid, docs/calibration.md)\n",
      ratio, fitted, kFittedSolid);
}

/// Of a solid: what the scene asks for, and what its model makes of that.
std::string poisson_text(const scene::Organ& organ) {
  const double asked = organ.solid.poisson_ratio;
  const double computed = deformation::computed_poisson_ratio(organ);
  return computed == asked ? fmt::format("{:g}", asked)
                           : fmt::format("{:g}, computed with {:.3f}", asked, computed);
}

std::string organ_text(const scene::Organ& organ, const geometry::OrganShape& shape,
                       const deformation::DeformationWorld& world, std::size_t index,
                       double period) {
  const SurfaceTopology& topology = deformation::surface_message(world, index);
  const double volume = geometry::enclosed_volume(shape.surface.nodes, shape.surface.triangles);
  std::array<std::size_t, 3> springs{};
  for (const auto& spring : topology.springs) ++springs[static_cast<std::size_t>(spring.family)];
  const int substeps = world.substeps(index, period);
  const std::size_t inner = topology.rest_positions.size() / 3 - topology.surface_node_count;
  std::string text =
      fmt::format("organ {}: {} surface nodes + {} {} nodes, {} fixed; {} triangles\n", organ.name,
                  topology.surface_node_count, inner, shape.is_solid() ? "inner" : "virtual",
                  topology.fixed_nodes.size(), topology.triangles.size());
  text += shape.is_solid()
              ? fmt::format("  {} {} tetrahedra, Poisson's ratio {}\n", shape.tetrahedra.size(),
                            shape.edge_nodes.empty() ? "linear" : "quadratic", poisson_text(organ))
              : fmt::format("  springs: {} structural, {} bending, {} inner\n", springs[0],
                            springs[1], springs[2]);
  text += fmt::format("  volume {:.1f} cm3, mass {:.3f} kg, model {}\n", 1e6 * volume,
                      organ.tissue.density * volume, organ.model);
  if (!shape.is_solid()) text += calibration_text(organ);
  if (scene::format_of(organ.model).has_integrator)
    text += integrator_text(organ, world.integrator(index));
  text += fmt::format("  largest step {:.1f} us: {} sub-steps of {:.1f} us in a period\n",
                      1e6 * world.stable_step(index), substeps, 1e6 * period / substeps);
  return text;
}

/// Opens the files a probe names, as its processes would. What is wrong with a recording, but can
/// be borne, is printed.
void check_probe(const scene::Probe& probe, const scene::Haptics& limits, std::ostream& out) {
  scene::load_probe_mesh(probe);
  std::vector<std::string> warnings;
  haptics::make_device(probe.device, limits, warnings);
  for (const auto& warning : warnings) out << "warning: " << warning << '\n';
}

constexpr double kTip = 5e-3;  // [m]

/// The scene with a sphere for its probes, which is moved from outside.
scene::Scene touched_by_sphere(scene::Scene scene) {
  scene.probes = {{"tip", scene::SphereShape{kTip}, 0.1, scene::ScriptedDevice{}}};
  return scene;
}

double wall_time() { return seconds_from_ns(runtime::monotonic_now_ns()); }

/// A session of the scene with its deformation timed.
class TimedSession {
 public:
  TimedSession(const scene::Scene& scene, std::vector<geometry::OrganShape> shapes,
               ChunkRunner& runner)
      : session_(touched_by_sphere(scene), {std::move(shapes), {geometry::TriangleSurface{}}},
                 options(runner)) {
    auto device = std::make_unique<haptics::PlacedDevice>(Pose{});
    tip_ = device.get();
    session_.haptics().set_device(0, std::move(device));
  }

  const deformation::DeformationWorld& world() const { return session_.world(); }
  ContactTroubles contact_troubles() const { return session_.contact_troubles(); }

  /// Wall time of deformation in a period, mean over about `measure_for` seconds [s]. The sphere
  /// presses a triangle that is free to move once a second, 1 mm deep: an implicit step that has
  /// nothing to do is no measure of one that has.
  double cost_of_period(double period, double measure_for) {
    place_tip();
    session_.run_until(period);  // memory is taken, caches are warm
    spent_ = 0;
    const double end = wall_time() + measure_for;
    int periods = 0;
    for (; wall_time() < end; ++periods) {
      place_tip();
      session_.run_until(session_.time() + period);
    }
    return periods > 0 ? spent_ / periods : 0;
  }

 private:
  session::InProcessOptions options(ChunkRunner& runner) {
    session::InProcessOptions options;
    options.runner = &runner;
    options.make = [this](std::string_view module, bus::Bus& bus,
                          const session::MakeStage& usual) -> std::unique_ptr<runtime::Stage> {
      if (module != "deformation") return usual(bus);
      return std::make_unique<session::TimedStage>(usual(bus), wall_time, spent_);
    };
    return options;
  }

  void place_tip() {
    const deformation::OrganModel& organ = world().model(0);
    const std::set<std::uint32_t> fixed(organ.fixed_nodes.begin(), organ.fixed_nodes.end());
    const auto free = std::find_if(
        organ.triangles.begin(), organ.triangles.end(), [&](const geometry::Triangle& t) {
          return std::none_of(t.begin(), t.end(), [&](auto node) { return fixed.contains(node); });
        });
    if (free == organ.triangles.end()) return;
    const auto corner = [&](std::size_t k) { return organ.rest_positions[(*free)[k]]; };
    const Vec3 n = (corner(1) - corner(0)).cross(corner(2) - corner(0)).normalized();
    const double depth = 0.5e-3 * (1 - std::cos(2 * M_PI * session_.time()));
    Pose pose;
    pose.position = (corner(0) + corner(1) + corner(2)) / 3 + (kTip - depth) * n;
    tip_->place(pose);
  }

  double spent_ = 0;  ///< in deformation so far [s]
  session::InProcess session_;
  haptics::PlacedDevice* tip_ = nullptr;
};

}  // namespace

int check_command(const std::filesystem::path& file, double measure_for, std::ostream& out) {
  const scene::Scene scene = scene::load_scene(file);
  out << scene::resolved_text(scene) << '\n';
  std::vector<geometry::OrganShape> shapes;
  for (const auto& organ : scene.organs) shapes.push_back(scene::load_organ(organ));
  for (const auto& probe : scene.probes) check_probe(probe, scene.haptics, out);
  runtime::WorkerTeam team(scene.deformation_threads);
  TimedSession session(scene, shapes, team);
  const double period = 1 / scene.rates.deformation;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    out << organ_text(scene.organs[i], shapes[i], session.world(), i, period);
  }
  out << fmt::format(
      "rates: haptics {:g} Hz, collision {:g} Hz, deformation {:g} Hz, visualizer {:g} Hz\n",
      scene.rates.haptics, scene.rates.collision, scene.rates.deformation, scene.rates.visualizer);
  const double cost = session.cost_of_period(period, measure_for);
  out << fmt::format(
      "cost here: {:.3f} ms per period of {:.3f} ms, lightly touched: {:.0f} % of one core\n",
      1e3 * cost, 1e3 * period, 100 * cost / period);
  out << session::contact_line(session.contact_troubles()) << '\n';
  out << (cost <= period
              ? fmt::format(
                    "expected real-time factor: 1.00 (up to {:.1f} with nothing else to do)\n",
                    period / cost)
              : fmt::format("expected real-time factor: {:.2f}, slower than real time\n",
                            period / cost));
  return kExitDone;
}

}  // namespace palpate::launcher
