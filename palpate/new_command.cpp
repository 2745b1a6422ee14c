#include "palpate/new_command.h"

#include <spdlog/fmt/fmt.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <ostream>
#include <vector>

#include "modules/core/error.h"
#include "modules/core/output_file.h"
#include "modules/core/units.h"
#include "modules/core/whole_file.h"
#include "modules/geometry/bounding_box.h"
#include "modules/geometry/mesh_prepare.h"
#include "modules/geometry/tools/gmsh_tool.h"
#include "modules/scene/scene_reader.h"
#include "modules/scene/value_text.h"
#include "palpate/mesh_command.h"
#include "palpate/run_options.h"
#include "palpate/scene_doubts.h"

namespace palpate::launcher {
namespace {

constexpr double kUsualSmallestOrgan = 0.03, kUsualLargestOrgan = 0.5;  // longest side [m]
constexpr std::size_t kUsualNodes = 1000, kMostUsualNodes = 2000;

/// Units in which the mesh would have an organ's size; the likelier first, for scanners and
/// modellers write millimetres.
std::vector<std::string> possible_units(double longest_side_in_file) {
  std::vector<std::string> units;
  for (const char* unit : {"mm", "m", "cm"}) {
    const double size = longest_side_in_file * metres_per_unit(unit);
    if (size >= kUsualSmallestOrgan && size <= kUsualLargestOrgan) units.push_back(unit);
  }
  return units;
}

struct Guess {
  std::string unit, said;
};

Guess unit_of(const NewOptions& options) {
  if (!options.unit.empty()) return {options.unit, "as told"};
  const auto raw = geometry::load_organ_surface(options.mesh, "m", 0);
  const double longest = geometry::bounding_box(raw.nodes).sizes().maxCoeff();
  const auto units = possible_units(longest);
  if (units.empty()) {
    throw InputError(
        fmt::format("{}: {:g} units long, which is no organ's size in mm, cm or m; say --unit",
                    options.mesh.string(), longest));
  }
  std::string said = "guessed";
  if (units.size() > 1) {
    said += fmt::format("; in {} it would be {:.0f} mm long", units[1],
                        1e3 * longest * metres_per_unit(units[1]));
  }
  return {units[0], said};
}

/// What a scene with the organ needs to know of it.
struct Layout {
  Eigen::AlignedBox3d box;
  double fixed_from = 0;         ///< nodes with greater y are held [m]
  Vec3 front = Vec3::Zero();     ///< of the surface, before its middle [m]
  double wall = 0;               ///< fitted to a solid (docs/calibration.md) [m]
  double radius = 0, depth = 0;  ///< of the sphere, of its press [m]
};

/// Where a press along y meets much of the organ: the node of the near half that faces the front
/// most, and lies before the middle.
Vec3 front_of(const geometry::TriangleSurface& surface, const Eigen::AlignedBox3d& box) {
  std::vector<Vec3> normals(surface.nodes.size(), Vec3::Zero());
  for (const auto& [a, b, c] : surface.triangles) {
    const Vec3 normal =
        (surface.nodes[b] - surface.nodes[a]).cross(surface.nodes[c] - surface.nodes[a]);
    for (const auto node : {a, b, c}) normals[node] += normal;
  }
  const Vec3 middle = box.center(), size = box.sizes();
  Vec3 front = surface.nodes.front();
  double best = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < surface.nodes.size(); ++i) {
    const Vec3& node = surface.nodes[i];
    if (node.y() > middle.y()) continue;
    const double aside =
        std::hypot((node.x() - middle.x()) / size.x(), (node.z() - middle.z()) / size.z());
    const double score = -normals[i].normalized().y() - 2 * aside;
    if (score <= best) continue;
    best = score;
    front = node;
  }
  return front;
}

Layout layout_of(const geometry::TriangleSurface& surface) {
  Layout layout;
  layout.box = geometry::bounding_box(surface.nodes);
  const Vec3 size = layout.box.sizes();
  std::vector<double> along;
  for (const Vec3& node : surface.nodes) along.push_back(node.y());
  // The farthest tenth of its nodes.
  const auto tenth = along.end() - std::max<std::ptrdiff_t>(3, std::ssize(along) / 10);
  std::nth_element(along.begin(), tenth, along.end());
  layout.fixed_from = *tenth - 1e-4;
  layout.front = front_of(surface, layout.box);
  const double volume = geometry::enclosed_volume(surface.nodes, surface.triangles);
  constexpr double kWallOverRadius = 0.16;  // docs/calibration.md, solid
  layout.wall = kWallOverRadius * std::cbrt(3 * volume / (4 * M_PI));
  layout.radius = std::clamp(0.06 * size.maxCoeff(), 2e-3, 8e-3);
  layout.depth = std::min(0.12 * size.y(), 0.015);
  return layout;
}

std::string vector_text(const Vec3& v) {
  return fmt::format("[{:.4f}, {:.4f}, {:.4f}]", v.x(), v.y(), v.z());
}

std::string scene_text(const std::filesystem::path& mesh, const std::string& unit,
                       std::size_t nodes, const Layout& layout) {
  const double margin = 0.02 * layout.box.sizes().maxCoeff();
  const Vec3 lowest = layout.box.min() - Vec3::Constant(margin);
  const Vec3 highest = layout.box.max() + Vec3::Constant(margin);
  const Vec3 back(lowest.x(), layout.fixed_from, lowest.z());
  const Vec3 start = layout.front - Vec3(0, layout.radius + 0.02, 0);
  const Vec3 pressed = layout.front - Vec3(0, layout.radius - layout.depth, 0);
  const Vec3 middle = layout.box.center();
  const double far = 2.2 * layout.box.sizes().maxCoeff();
  std::string text =
      "# Made from a mesh by `palpate new`. Keys end in their unit; everything is SI.\n"
      "# docs/scene.md lists every key (installed in share/doc/palpate); `palpate check` says what "
      "this\n"
      "# holds and costs.\n"
      "palpate_scene: 1\n"
      "organs:\n";
  text += fmt::format("  - name: {}\n    mesh:\n      file: {}\n      unit: {}\n", "organ",
                      scene::quoted_text(mesh.string()), unit);
  if (nodes > 0) {
    text += fmt::format("      nodes: {}   # resampled: 500 to 2000 run in real time\n", nodes);
  }
  text += fmt::format(
      "    # A solid organ of springs as fitted (docs/calibration.md): inner_ratio 10 and a wall "
      "of 0.16\n"
      "    # of its radius. A hollow one: its wall's own thickness, and inner_ratio 0.05\n"
      "    tissue: {{youngs_modulus_pa: 10e3, wall_thickness_m: {:.2g}, density_kg_per_m3: 1050}}\n"
      "    springs: {{inner_ratio: 10}}\n"
      "    fixed:   # what lies on the spine: the farthest tenth of its nodes\n"
      "      - box: {{min_m: {}, max_m: {}}}\n"
      "probes:\n"
      "  - name: probe\n"
      "    shape: {{sphere: {{radius_m: {:.4f}}}}}\n"
      "    device:   # `palpate list devices` says what else may move it\n"
      "      scripted:\n"
      "        start_m: {}\n"
      "        moves:\n"
      "          - {{to_m: {}, duration_s: 3}}   # {:.0f} mm deep\n"
      "          - {{wait_s: 1}}\n"
      "          - {{to_m: {}, duration_s: 2}}\n"
      "# It runs until q or Ctrl-C; duration_s: 8 would end it after 8 s.\n"
      "camera: {{position_m: {}, target_m: {}}}\n",
      layout.wall, vector_text(back), vector_text(highest), layout.radius, vector_text(start),
      vector_text(pressed), 1e3 * layout.depth, vector_text(start),
      vector_text(middle + Vec3(-0.3 * far, -far, 0.3 * far)), vector_text(middle));
  return text;
}

}  // namespace

int new_command(const NewOptions& options, std::ostream& out) {
  if (options.mesh.extension() == ".yaml") {
    throw InputError(options.mesh.string() + ": a scene, not a mesh: palpate run takes it");
  }
  if (geometry::is_tetrahedra_file(options.mesh)) {
    geometry::refuse_tetrahedra(options.mesh, "`palpate new` makes scenes of surfaces");
  }
  std::filesystem::path output = options.output;
  if (output.empty()) output = options.mesh.stem().string() + ".yaml";
  if (std::filesystem::exists(output)) {
    throw InputError(output.string() + ": is there already; --output names another");
  }
  check_writable(output);
  const Guess guess = unit_of(options);
  auto surface = geometry::load_organ_surface(options.mesh, guess.unit, 0);
  check_organ_size(options.mesh.string(), {options.mesh, guess.unit},
                   geometry::bounding_box(surface.nodes).sizes().maxCoeff(), UnitIs::kOption);
  const std::size_t nodes = surface.nodes.size() > kMostUsualNodes ? kUsualNodes : 0;
  const std::size_t found = surface.nodes.size();
  if (nodes > 0) surface = geometry::load_organ_surface(options.mesh, guess.unit, nodes);
  const auto folder = std::filesystem::absolute(output).parent_path();
  const auto mesh = std::filesystem::absolute(options.mesh).lexically_proximate(folder);
  const std::string text = scene_text(mesh, guess.unit, nodes, layout_of(surface));
  scene::parse_scene(text, folder / output.filename());  // what we write can be read
  write_whole_file(output, text);
  const Vec3 size = 1e3 * geometry::bounding_box(surface.nodes).sizes();
  out << fmt::format("{}: {:.0f} x {:.0f} x {:.0f} mm in {} ({}), {} nodes{}\n",
                     options.mesh.string(), size.x(), size.y(), size.z(), guess.unit, guess.said,
                     found,
                     nodes > 0 ? fmt::format(", resampled to {}", surface.nodes.size()) : "");
  const std::string typed = shell_word(output.string());
  out << fmt::format("written: {}\n  palpate check {}\n  palpate run {}\n", output.string(), typed,
                     typed);
  return kExitDone;
}

}  // namespace palpate::launcher
