#include "palpate/mesh_command.h"

#include <cmath>
#include <iomanip>
#include <ostream>
#include <sstream>

#include "modules/core/error.h"
#include "modules/geometry/mesh_io.h"
#include "modules/geometry/mesh_prepare.h"

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
                 " mm, ratio " + number(report.longest_edge / report.shortest_edge, 3) +
                 ", worst aspect " + number(report.worst_aspect, 3));
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

void refuse_if_leaky(const MeshReport& report, const TriangleSurface& surface,
                     const std::filesystem::path& file) {
  if (report.holds_volume()) return;
  std::string message = file.string() + ": cannot hold a volume; nothing written";
  for (const std::string& problem : describe_problems(report, surface)) {
    message += "\n  " + problem;
  }
  throw InputError(message);
}

TriangleSurface resample(const TriangleSurface& surface, const MeshCommandOptions& options) {
  try {
    return resample_surface(surface, options.node_count);
  } catch (const InputError& error) {
    throw InputError(options.input.string() + ": " + error.what());
  }
}

void prepare_and_write(const MeshCommandOptions& options, std::ostream& out) {
  if (!options.output.empty()) check_can_write(options.output);
  TriangleSurface surface = read_surface(options.input, options.unit);
  out << options.input.string() << " (" << options.unit << ")\n";
  print_measures(check_surface(surface), out);
  const RepairLog log = repair_surface(surface);
  out << "repairs\n";
  for (const std::string& action : log.actions) out << "  " << action << '\n';
  if (log.actions.empty()) out << "  none needed\n";
  const MeshReport repaired = check_surface(surface);
  out << "checks\n";
  print_checks(repaired, out);
  refuse_if_leaky(repaired, surface, options.input);
  if (options.node_count > 0) {
    surface = resample(surface, options);
    out << "resampled\n";
    const MeshReport resampled = check_surface(surface);
    print_measures(resampled, out);
    refuse_if_leaky(resampled, surface, options.input);
  }
  if (options.output.empty()) return;
  write_surface(surface, options.output);
  out << "written: " << options.output.string() << " (m)\n";
}

}  // namespace

int run_mesh_command(const MeshCommandOptions& options, std::ostream& out, std::ostream& err) {
  try {
    prepare_and_write(options, out);
    return kExitDone;
  } catch (const InputError& error) {
    err << error.what() << '\n';
    return kExitBadInput;
  } catch (const std::exception& error) {
    err << error.what() << '\n';
    return kExitFailed;
  }
}

}  // namespace palpate::geometry
