#include "modules/launcher/check_command.h"

#include <spdlog/fmt/fmt.h>

#include <array>
#include <ostream>

#include "deformation/deformation_world.h"
#include "modules/core/error.h"
#include "modules/core/units.h"
#include "modules/geometry/triangle_surface.h"
#include "modules/runtime/clock.h"
#include "modules/scene/assets.h"
#include "modules/scene/scene_reader.h"
#include "modules/scene/schema.h"

namespace palpate::launcher {
namespace {

std::string organ_text(const scene::Organ& organ, const geometry::TriangleSurface& surface,
                       const deformation::DeformationWorld& world, std::size_t index,
                       double period) {
  const SurfaceTopology& topology = world.topology(index);
  const double volume = geometry::enclosed_volume(surface.nodes, surface.triangles);
  std::array<std::size_t, 3> springs{};
  for (const auto& spring : topology.springs) ++springs[static_cast<std::size_t>(spring.family)];
  const int substeps = world.substeps(index, period);
  std::string text = fmt::format(
      "organ {}: {} surface nodes + {} virtual nodes, {} fixed; {} triangles\n"
      "  springs: {} structural, {} bending, {} inner\n"
      "  volume {:.1f} cm3, mass {:.3f} kg, model {}\n",
      organ.name, topology.surface_node_count,
      topology.rest_positions.size() / 3 - topology.surface_node_count, topology.fixed_nodes.size(),
      topology.triangles.size(), springs[0], springs[1], springs[2], 1e6 * volume,
      organ.tissue.density * volume, scene::word_of(organ.model));
  text += fmt::format("  stable step {:.1f} us: {} sub-steps of {:.1f} us in a period\n",
                      1e6 * world.stable_step(index), substeps, 1e6 * period / substeps);
  return text;
}

/// Wall time of an advance by one period, mean over about `measure_for` seconds [s].
double measured_cost(deformation::DeformationWorld& world, double period, double measure_for) {
  world.advance(period);  // memory is taken, caches are warm
  const std::int64_t begin = runtime::monotonic_now_ns();
  const std::int64_t end = begin + ns_from_seconds(measure_for);
  std::int64_t now = begin;
  int advances = 0;
  for (; now < end; ++advances) {
    world.advance(period);
    now = runtime::monotonic_now_ns();
  }
  return advances > 0 ? seconds_from_ns(now - begin) / advances : 0;
}

}  // namespace

int check_command(const std::filesystem::path& file, double measure_for, std::ostream& out) {
  const scene::Scene scene = scene::load_scene(file);
  out << scene::resolved_text(scene) << '\n';
  std::vector<geometry::TriangleSurface> surfaces;
  for (const auto& organ : scene.organs) surfaces.push_back(scene::load_organ(organ));
  deformation::DeformationWorld world(scene, surfaces);
  const double period = 1 / scene.rates.deformation;
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    out << organ_text(scene.organs[i], surfaces[i], world, i, period);
  }
  out << fmt::format(
      "rates: haptics {:g} Hz, collision {:g} Hz, deformation {:g} Hz, visualizer {:g} Hz\n",
      scene.rates.haptics, scene.rates.collision, scene.rates.deformation, scene.rates.visualizer);
  const double cost = measured_cost(world, period, measure_for);
  out << fmt::format(
      "cost here: {:.3f} ms per period of {:.3f} ms, untouched: {:.0f} % of one core\n", 1e3 * cost,
      1e3 * period, 100 * cost / period);
  out << (cost <= period
              ? fmt::format(
                    "expected real-time factor: 1.00 (up to {:.1f} with nothing else to do)\n",
                    period / cost)
              : fmt::format("expected real-time factor: {:.2f}, slower than real time\n",
                            period / cost));
  return kExitDone;
}

}  // namespace palpate::launcher
