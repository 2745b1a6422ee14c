#include "palpate/check_command.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <ostream>
#include <set>

#include "deformation/organ_messages.h"
#include "deformation/world.h"
#include "haptics/device.h"
#include "modules/core/error.h"
#include "modules/core/units.h"
#include "modules/geometry/organ_shape.h"
#include "modules/runtime/clock.h"
#include "modules/runtime/worker_team.h"
#include "modules/scene/assets.h"
#include "modules/scene/models.h"
#include "modules/scene/scene_reader.h"
#include "modules/scene/schema.h"

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
              ? fmt::format("  {} {} tetrahedra, Poisson's ratio {:g}\n", shape.tetrahedra.size(),
                            shape.edge_nodes.empty() ? "linear" : "quadratic",
                            organ.solid.poisson_ratio)
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
void check_probe(const scene::Probe& probe, std::ostream& out) {
  scene::load_probe_mesh(probe);
  std::vector<std::string> warnings;
  haptics::make_device(probe.device, warnings);
  for (const auto& warning : warnings) out << "warning: " << warning << '\n';
}

/// Distance of a probe's origin from what it touches in direction n, for round shapes [m].
double reach(const scene::ProbeShape& shape, const Vec3& n) {
  if (const auto* sphere = std::get_if<scene::SphereShape>(&shape)) return sphere->radius;
  if (const auto* capsule = std::get_if<scene::CapsuleShape>(&shape)) {
    return capsule->radius + 0.5 * capsule->length * std::abs(n.z());
  }
  return 0;
}

/// Presses the first probe into a triangle of the first organ that is free to move, `depth` [m]
/// deep: an implicit step that has nothing to do is no measure of one that has.
void press(deformation::DeformationWorld& world, const scene::Scene& scene, double depth) {
  const SurfaceTopology& topology = deformation::surface_message(world, 0);
  const std::set<std::uint32_t> fixed(topology.fixed_nodes.begin(), topology.fixed_nodes.end());
  const auto free = std::find_if(
      topology.triangles.begin(), topology.triangles.end(), [&](const geometry::Triangle& t) {
        return std::none_of(t.begin(), t.end(), [&](auto node) { return fixed.contains(node); });
      });
  if (free == topology.triangles.end()) return;
  std::array<Vec3, 3> corners;
  for (std::size_t k = 0; k < 3; ++k) {
    corners[k] =
        Eigen::Map<const Eigen::Vector3f>(&topology.rest_positions[std::size_t{3} * (*free)[k]])
            .cast<double>();
  }
  const Vec3 n = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized();
  const Vec3 point = (corners[0] + corners[1] + corners[2]) / 3 - depth * n;
  ProbeState probe;
  probe.pose.position = point + reach(scene.probes[0].shape, n) * n;
  Contact contact;
  contact.triangle = static_cast<std::uint32_t>(free - topology.triangles.begin());
  contact.barycentric = Vec3::Constant(1.0 / 3);
  contact.point_on_probe = point;
  contact.normal = n;
  contact.gap = -depth;
  Contacts contacts;
  contacts.probe_pose = probe.pose;
  contacts.contacts.push_back(contact);
  world.set_contacts(contacts);
  world.set_probe(probe.probe, probe.pose);
}

/// Wall time of an advance by one period with a probe that presses the organ once a second, 1 mm
/// deep; mean over about `measure_for` seconds [s].
double measured_cost(deformation::DeformationWorld& world, const scene::Scene& scene, double period,
                     double measure_for) {
  world.advance(period);  // memory is taken, caches are warm
  const std::int64_t begin = runtime::monotonic_now_ns();
  const std::int64_t end = begin + ns_from_seconds(measure_for);
  std::int64_t now = begin;
  int advances = 0;
  for (; now < end; ++advances) {
    press(world, scene, 0.5e-3 * (1 - std::cos(2 * M_PI * world.time())));
    world.advance(period);
    now = runtime::monotonic_now_ns();
  }
  return advances > 0 ? seconds_from_ns(now - begin) / advances : 0;
}

}  // namespace

int check_command(const std::filesystem::path& file, double measure_for, std::ostream& out) {
  const scene::Scene scene = scene::load_scene(file);
  out << scene::resolved_text(scene) << '\n';
  std::vector<geometry::OrganShape> shapes;
  for (const auto& organ : scene.organs) shapes.push_back(scene::load_organ(organ));
  for (const auto& probe : scene.probes) check_probe(probe, out);
  runtime::WorkerTeam team(scene.deformation_threads);
  deformation::DeformationWorld world(scene, shapes, &team);
  const double period = 1 / scene.rates.deformation;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    out << organ_text(scene.organs[i], shapes[i], world, i, period);
  }
  out << fmt::format(
      "rates: haptics {:g} Hz, collision {:g} Hz, deformation {:g} Hz, visualizer {:g} Hz\n",
      scene.rates.haptics, scene.rates.collision, scene.rates.deformation, scene.rates.visualizer);
  const double cost = measured_cost(world, scene, period, measure_for);
  out << fmt::format(
      "cost here: {:.3f} ms per period of {:.3f} ms, lightly touched: {:.0f} % of one core\n",
      1e3 * cost, 1e3 * period, 100 * cost / period);
  out << (cost <= period
              ? fmt::format(
                    "expected real-time factor: 1.00 (up to {:.1f} with nothing else to do)\n",
                    period / cost)
              : fmt::format("expected real-time factor: {:.2f}, slower than real time\n",
                            period / cost));
  return kExitDone;
}

}  // namespace palpate::launcher
