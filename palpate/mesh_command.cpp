#include "palpate/mesh_command.h"

#include <json/json.h>

#include <cmath>
#include <iomanip>
#include <ostream>
#include <sstream>

#include "modules/core/error.h"
#include "modules/core/output_file.h"
#include "modules/core/units.h"
#include "modules/geometry/bounding_box.h"
#include "modules/geometry/mesh_io.h"
#include "modules/geometry/mesh_prepare.h"
#include "modules/geometry/organ_shape.h"
#include "modules/geometry/shells.h"
#include "modules/geometry/tools/gmsh_tool.h"
#include "palpate/scene_doubts.h"

namespace palpate::geometry {
namespace {

std::string number(double value, int digits = 4) {
  std::ostringstream text;
  text << std::setprecision(digits) << value;
  return text.str();
}

void print_line(std::ostream& out, const std::string& name, const std::string& value) {
  out << "  " << std::left << std::setw(24) << name << value << '\n';
}

/// Nothing of a mesh whose triangles are points.
std::string proportions(const MeshReport& report) {
  const double ratio = report.longest_edge / report.shortest_edge;
  if (!std::isfinite(ratio) || !std::isfinite(report.worst_aspect)) return "";
  return ", ratio " + number(ratio, 3) + ", worst aspect " + number(report.worst_aspect, 3);
}

void print_measures(const MeshReport& report, std::ostream& out) {
  const Vec3 size = 1e3 * (report.max_corner - report.min_corner);
  print_line(out, "nodes, triangles",
             std::to_string(report.node_count) + ", " + std::to_string(report.triangle_count));
  print_line(out, "size",
             number(size.x()) + " x " + number(size.y()) + " x " + number(size.z()) + " mm");
  print_line(out, "volume, area",
             number(1e6 * report.volume) + " cm³, " + number(1e4 * report.area) + " cm²");
  print_line(out, "edges",
             number(1e3 * report.shortest_edge) + " to " + number(1e3 * report.longest_edge) +
                 " mm" + proportions(report));
}

void print_check(std::ostream& out, const std::string& name, std::size_t offenders) {
  print_line(out, name, offenders == 0 ? "ok" : "WRONG: " + std::to_string(offenders));
}

void print_checks(const MeshReport& report, std::ostream& out) {
  constexpr double kTightLeak = 1e-9;  // rounding of 10⁵ triangles, far below one open triangle
  print_check(out, "closed (open edges)", report.border_edges.size());
  print_line(out, "three-axis leak test",
             (report.leak <= kTightLeak ? "ok, " : "WRONG: ") + number(report.leak, 2));
  print_check(out, "manifold edges", report.non_manifold_edges.size());
  print_check(out, "manifold nodes", report.non_manifold_nodes.size());
  const std::string genus =
      report.border_edges.empty() ? ", genus " + std::to_string(report.genus) : "";
  print_line(out, "shells",
             (report.component_count == 1 ? "ok, " : "WRONG: ") +
                 std::to_string(report.component_count) + genus);
  print_check(out, "consistent orientation", report.inconsistent_edges.size());
  print_line(out, "outward", report.inside_out ? "WRONG: inside out" : "ok");
  print_check(out, "duplicate triangles", report.duplicate_triangles.size());
  print_check(out, "triangles without area", report.degenerate_triangles.size());
  print_check(out, "self-intersections", report.self_intersections.size());
  print_check(out, "unused nodes", report.unused_nodes.size());
}

/// "--largest keeps 4000 nodes, 1432 cm³ and drops 1 shell with 3.2 cm³ in all", where there are
/// several.
std::string shells_hint(const TriangleSurface& surface) {
  const auto shells = shells_of(surface);
  if (shells.size() < 2) return "";
  double dropped = 0;
  for (std::size_t i = 1; i < shells.size(); ++i) {
    dropped += std::abs(enclosed_volume(shells[i].nodes, shells[i].triangles));
  }
  const double kept = std::abs(enclosed_volume(shells[0].nodes, shells[0].triangles));
  return "--largest keeps the shell with " + std::to_string(shells[0].nodes.size()) +
         " nodes and " + number(1e6 * kept) + " cm³, and drops " +
         std::to_string(shells.size() - 1) + " with " + number(1e6 * dropped) + " cm³ in all";
}

/// "--fill-holes closes 2 holes and encloses 1432 cm³", where there are any.
std::string holes_hint(TriangleSurface surface) {
  const std::size_t filled = fill_holes(surface);
  if (filled == 0) return "";
  return "--fill-holes closes " + std::to_string(filled) + (filled == 1 ? " hole" : " holes") +
         " and encloses " +
         number(1e6 * std::abs(enclosed_volume(surface.nodes, surface.triangles))) + " cm³";
}

void refuse_if_leaky(const MeshReport& report, const TriangleSurface& surface,
                     const std::filesystem::path& file) {
  if (report.holds_volume()) return;
  std::string message = file.string() + ": cannot hold a volume; nothing written";
  for (const std::string& problem : describe_problems(report, surface)) {
    message += "\n  " + problem;
  }
  for (const std::string& hint : {shells_hint(surface), holes_hint(surface)}) {
    if (!hint.empty()) message += "\n  " + hint;
  }
  throw InputError(message);
}

TriangleSurface resample(const TriangleSurface& surface, const MeshCommandOptions& options,
                         std::ostream& log) {
  const std::string file = options.input.string();
  try {
    return resample_surface(
        surface, options.node_count,
        [&, tell = launcher::resampling_on(log)](double part) { tell(file, part); });
  } catch (const InputError& error) {
    throw InputError(options.input.string() + ": " + error.what());
  }
}

/// Of tetrahedra.
std::string scene_hint(const std::filesystem::path& file) {
  return "A scene takes them as they are: organs: [{mesh: {file: " + file.filename().string() +
         "}, model: nodal_pressure}]";
}

void check_output(const MeshCommandOptions& options) {
  if (options.output.empty()) return;
  options.near.file.empty() ? check_can_write(options.output)
                            : check_can_write_tetrahedra(options.output);
  check_writable(options.output);
  if (options.overwrite || !std::filesystem::exists(options.output)) return;
  throw InputError(options.output.string() +
                   ": is there already; give another name, or --overwrite");
}

void check_options(const MeshCommandOptions& options) {
  const NearMotion& near = options.near;
  const bool is_filled = is_tetrahedra_file(options.input);
  if (near.file.empty()) {
    if (!is_filled) return;
    refuse_tetrahedra(options.input,
                      "`palpate mesh` prepares surfaces, and halves tetrahedra with --near alone");
  }
  if (!near.columns.empty() && near.columns.size() != 4) {
    throw InputError("--near-columns must name four: time, x, y, z");
  }
  if (!near.radius) throw InputError("--near needs --radius-m, of the sphere that moves so");
  if (is_filled && (options.node_count > 0 || options.largest || options.fill_holes)) {
    throw InputError(
        options.input.string() +
        ": is read as tetrahedra; --nodes, --largest and --fill-holes are of surfaces");
  }
}

/// What was asked for beside the usual repairs.
std::vector<std::string> mend(TriangleSurface& surface, const MeshCommandOptions& options) {
  std::vector<std::string> actions;
  if (options.fill_holes) {
    const std::size_t filled = fill_holes(surface);
    actions.push_back("closed " + std::to_string(filled) + (filled == 1 ? " hole" : " holes"));
  }
  if (options.largest) {
    auto shells = shells_of(surface);
    actions.push_back("dropped " + std::to_string(shells.size() - 1) + " of " +
                      std::to_string(shells.size()) + " shells");
    surface = std::move(shells.front());
  }
  const RepairLog log = repair_surface(surface);  // shells and patches may face inward
  actions.insert(actions.end(), log.actions.begin(), log.actions.end());
  return actions;
}

Json::Value json_of(const MeshReport& report) {
  Json::Value value;
  value["nodes"] = Json::UInt64(report.node_count);
  value["triangles"] = Json::UInt64(report.triangle_count);
  for (const double side : Vec3(report.max_corner - report.min_corner)) {
    value["size_m"].append(side);
  }
  value["volume_m3"] = report.volume;
  value["area_m2"] = report.area;
  value["shortest_edge_m"] = report.shortest_edge;
  value["longest_edge_m"] = report.longest_edge;
  value["shells"] = Json::UInt64(report.component_count);
  value["open_edges"] = Json::UInt64(report.border_edges.size());
  value["self_intersections"] = Json::UInt64(report.self_intersections.size());
  value["holds_volume"] = report.holds_volume();
  return value;
}

/// A mesh may be of something else than an organ; a scene refuses it.
void doubt_size(const MeshCommandOptions& options, double size, Json::Value& json,
                std::ostream& out) {
  try {
    launcher::check_organ_size("the surface", {options.input, options.unit}, size,
                               launcher::UnitIs::kOption);
  } catch (const InputError& doubt) {
    out << "warning: " << doubt.what() << '\n';
    json["warnings"].append(doubt.what());
  }
}

/// The surface that was asked for, step by step told to `out`.
TriangleSurface prepare(const MeshCommandOptions& options, Json::Value& json, std::ostream& out,
                        std::ostream& progress) {
  TriangleSurface surface = read_surface(options.input, options.unit);
  const MeshReport found = check_surface(surface);
  out << options.input.string() << " (" << options.unit << ")\n";
  print_measures(found, out);
  doubt_size(options, (found.max_corner - found.min_corner).maxCoeff(), json, out);
  RepairLog log = repair_surface(surface);
  if (options.fill_holes || options.largest) {
    for (auto& action : mend(surface, options)) log.actions.push_back(std::move(action));
  }
  out << "repairs\n";
  for (const std::string& action : log.actions) out << "  " << action << '\n';
  if (log.actions.empty()) out << "  none needed\n";
  MeshReport report = check_surface(surface);
  if (report.node_count != found.node_count || report.triangle_count != found.triangle_count) {
    out << "repaired\n";
    print_measures(report, out);
  }
  out << "checks\n";
  print_checks(report, out);
  json["found"] = json_of(found);
  json["repairs"] = Json::arrayValue;
  for (const std::string& action : log.actions) json["repairs"].append(action);
  json["result"] = json_of(report);
  refuse_if_leaky(report, surface, options.input);
  if (options.node_count > 0) {
    surface = resample(surface, options, progress);
    out << "resampled\n";
    report = check_surface(surface);
    print_measures(report, out);
    json["result"] = json_of(report);
    refuse_if_leaky(report, surface, options.input);
  }
  return surface;
}

TetMesh filled(const MeshCommandOptions& options, Json::Value& json, std::ostream& out,
               std::ostream& progress) {
  if (!is_tetrahedra_file(options.input)) {
    const TriangleSurface surface = prepare(options, json, out, progress);
    try {
      return fill_surface(surface, mean_edge_length(surface));
    } catch (const InputError& error) {
      const std::string why = error.what();
      const char* advice = "; they are as long as the surface's edges: give fewer --nodes";
      throw InputError(options.input.string() + ": " + why +
                       (why.starts_with("elements of") ? advice : ""));
    }
  }
  TetMesh mesh = read_tetrahedra(options.input);
  const double scale = metres_per_unit(options.unit);
  for (Vec3& node : mesh.nodes) node *= scale;
  out << options.input.string() << " (" << options.unit << ")\n";
  try {
    doubt_size(options, bounding_box(shape_of(mesh).surface.nodes).sizes().maxCoeff(), json, out);
  } catch (const InputError& error) {
    throw InputError(options.input.string() + ": " + error.what());
  }
  return mesh;
}

/// The tetrahedra that were asked for, step by step told to `out`.
TetMesh refine(const MeshCommandOptions& options, Json::Value& json, std::ostream& out,
               std::ostream& progress) {
  const SphereWay way = read_way(options.near);  // first: what is wrong with it is soon told
  const TetMesh coarse = filled(options, json, out, progress);
  const auto counts = [](const TetMesh& mesh) {
    return std::to_string(mesh.nodes.size()) + ", " + std::to_string(mesh.tetrahedra.size());
  };
  out << "filled\n";
  print_line(out, "nodes, tetrahedra", counts(coarse));
  const auto [mesh, refinement] = refined_near(coarse, options.near, way);
  out << "near " << options.near.file.string() << '\n';
  for (const std::string& note : way.notes) {
    out << "warning: " << note << '\n';
    json["warnings"].append(note);
  }
  print_line(out, "touched",
             std::to_string(refinement.near.size()) + " places, each within " +
                 number(1e3 * *options.near.radius) + " mm");
  print_line(out, "edges there",
             "at most " + number(1e3 * *refinement.edge_length) + " mm, and " +
                 number(*refinement.growth) + " of the distance longer");
  print_line(out, "nodes, tetrahedra", counts(mesh));
  Json::Value& near = json["near"];
  near["places"] = Json::UInt64(refinement.near.size());
  near["edge_m"] = *refinement.edge_length;
  near["growth"] = *refinement.growth;
  near["nodes"] = Json::UInt64(mesh.nodes.size());
  near["tetrahedra"] = Json::UInt64(mesh.tetrahedra.size());
  return mesh;
}

void prepare_and_write(const MeshCommandOptions& options, std::ostream& out,
                       std::ostream& progress) {
  check_options(options);
  check_output(options);
  Json::Value json;
  json["file"] = options.input.string();
  std::ostringstream unheard;
  std::ostream& text = options.json ? unheard : out;
  const auto print_json = [&] {
    if (options.json) out << Json::writeString(Json::StreamWriterBuilder(), json) << '\n';
  };
  try {
    const bool is_near = !options.near.file.empty();
    TriangleSurface surface;
    TetMesh tetrahedra;
    if (is_near) {
      tetrahedra = refine(options, json, text, progress);
    } else {
      surface = prepare(options, json, text, progress);
    }
    if (!options.output.empty()) {
      is_near ? write_tetrahedra(tetrahedra, options.output)
              : write_surface(surface, options.output);
      text << "written: " << options.output.string() << " (m)\n";
      if (is_near) text << scene_hint(options.output) << '\n';
      json["written"] = options.output.string();
    }
  } catch (const InputError&) {
    print_json();
    throw;
  }
  print_json();
}

}  // namespace

void refuse_tetrahedra(const std::filesystem::path& file, const std::string& tool) {
  read_tetrahedra(file);  // what is wrong with it comes first
  throw InputError(file.string() + ": holds tetrahedra; " + tool + ". " + scene_hint(file));
}

int run_mesh_command(const MeshCommandOptions& options, std::ostream& out, std::ostream& err) {
  try {
    prepare_and_write(options, out, err);
    return kExitDone;
  } catch (const InputError& error) {
    err << error.what() << '\n';
    return kExitBadInput;
  } catch (const Interrupted& error) {
    err << error.what() << '\n';
    return kExitStopped;
  } catch (const std::exception& error) {
    err << error.what() << '\n';
    return kExitFailed;
  }
}

}  // namespace palpate::geometry
