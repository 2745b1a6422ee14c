#include "studies/stability/locking.h"

#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <sstream>
#include <stdexcept>

#include "deformation/models.h"
#include "modules/geometry/primitives.h"
#include "modules/geometry/tools/gmsh_tool.h"
#include "modules/scene/models.h"
#include "modules/scene/schema.h"
#include "studies/chart/case_parts.h"
#include "studies/elements/load_path.h"
#include "studies/report/table_file.h"

namespace palpate::stability {
namespace {

constexpr int kLockingVersion = 1;    // of what is stored
constexpr double kDensity = 1060;     // [kg/m³]
constexpr double kPlateSpeed = 0.02;  // [m/s]
constexpr double kCriticalDrag = 60;  // about critical for the slowest mode [1/s]
constexpr double kRate = 100;         // steps asked for per second [Hz]
constexpr double kPenalty = 3e4 * kLockingModulus / kBallRadius;  // as in studies/elements [Pa/m]
constexpr double kStride = 0.025;                                 // of compression
constexpr double kEdge = 0.16;  // of the reference\'s mesh at the surface, of the radius

geometry::OrganShape solid_ball() {
  const auto surface = geometry::make_ball(kBallRadius, 2);
  const auto edges = geometry::edges_of(surface.triangles);
  double sum = 0;
  for (const auto& [a, b] : edges) sum += (surface.nodes[a] - surface.nodes[b]).norm();
  return geometry::shape_of(
      geometry::fill_surface(surface, sum / static_cast<double>(edges.size())));
}

scene::Scene ball_scene(const std::string& model, double poisson_ratio) {
  scene::Scene scene;
  const chart::Setting setting{model, 0, kRate};
  scene.organs.push_back(chart::solid_organ(setting, kBallRadius, 1, kLockingModulus, kDensity));
  scene.organs[0].solid.poisson_ratio = poisson_ratio;
  scene.organs[0].tissue.drag = kCriticalDrag;
  scene.rates.deformation = kRate;
  return scene;
}

/// An octant, three times coarser in the middle, where nothing happens.
deformation::TaylorHoodElements octant(double poisson_ratio) {
  auto mesh = deformation::make_quadratic(geometry::mesh_ball(
      kBallRadius, geometry::BallPart::kOctant,
      fmt::format("{:g} - {:g}*(x*x+y*y+z*z)", 3 * kEdge * kBallRadius, 2 * kEdge / kBallRadius)));
  deformation::curve_onto_sphere(mesh, Vec3::Zero(), kBallRadius);
  return {std::move(mesh), deformation::ElasticConstants(kLockingModulus, poisson_ratio), kDensity};
}

std::vector<char> symmetry_of(const deformation::TaylorHoodElements& solid) {
  std::vector<char> constrained;
  for (const Vec3& p : solid.mesh().nodes) {
    for (int axis = 0; axis < 3; ++axis) constrained.push_back(p[axis] == 0);
  }
  return constrained;
}

std::vector<std::uint32_t> outer_faces(const deformation::TaylorHoodElements& solid) {
  std::vector<std::uint32_t> faces;
  const auto& mesh = solid.mesh();
  for (std::uint32_t f = 0; f < mesh.faces.size(); ++f) {
    bool outside = true;
    for (int k = 0; k < 3; ++k) {
      outside &= mesh.nodes[mesh.face_node(mesh.faces[f], k)].norm() > (1 - 1e-6) * kBallRadius;
    }
    if (outside) faces.push_back(f);
  }
  return faces;
}

/// Force and divergence, in a file of their own. @returns false if it is not there, or not whole
bool read_point(const report::PointFiles& files, const std::string& name, double& force,
                bool& has_diverged) {
  std::istringstream stream(files.read(name).value_or(""));
  char comma = 0;
  int diverged = 0;
  std::string title;
  if (!std::getline(stream, title) || !(stream >> force >> comma >> diverged)) return false;
  has_diverged = diverged != 0;
  return true;
}

void write_point(const report::PointFiles& files, const std::string& name, double force,
                 bool diverged) {
  const std::vector<std::string> columns{"force_n", "diverged"};
  const std::vector<double> values{force, double(diverged)};
  files.write(name, report::table_line(columns) + report::table_line(values));
}

}  // namespace

double locking_reference(double poisson_ratio, const KeepGoing& keep_going) {
  const deformation::TaylorHoodElements solid = octant(poisson_ratio);
  deformation::RigidContact contact(solid, outer_faces(solid), kPenalty);
  deformation::QuasiStaticNewton solver(solid, symmetry_of(solid), &contact);
  const elements_bench::Setting setting{{},
                                        false,
                                        [&] {
                                          keep_going();
                                          return false;
                                        },
                                        [](const std::string&) {}};
  elements_bench::LoadPath path(solid, solver, &contact, setting);
  path.set_longest_stride(kStride);
  const bool done = path.advance_to(kLockingCompression, [&](double at, deformation::SolidState&) {
    contact.set_obstacles({deformation::Plane{Vec3(0, 0, kBallRadius * (1 - at)), -Vec3::UnitZ()}});
  });
  if (!done) {
    throw std::runtime_error(
        fmt::format("locking: no equilibrium of the reference at ν = {:g}", poisson_ratio));
  }
  return 4 * contact.outcomes(path.state())[0].force.z();
}

LockingPoint locking_point(const std::string& model, double poisson_ratio,
                           const KeepGoing& keep_going) {
  static const geometry::OrganShape kBall = solid_ball();
  scene::Scene scene = ball_scene(model, poisson_ratio);
  const auto plates = rigs::add_plates(scene);
  rigs::PressedOrgan pressed(
      scene, scene::is_quadratic(model) ? geometry::with_edge_nodes(kBall) : kBall, plates);
  const double height = kBallRadius * (1 - kLockingCompression);
  pressed.move_and_settle({{0, 0, height}, {0, 0, -height}}, kPlateSpeed, keep_going);
  LockingPoint point;
  point.diverged = pressed.diverged() || pressed.lacks_contacts();
  point.force = (std::abs(pressed.force(0).z()) + std::abs(pressed.force(1).z())) / 2;
  return point;
}

std::vector<double> locking_ratios(bool quick) {
  if (quick) return {0.3, 0.45, 0.499};
  return {0.3, 0.4, 0.45, 0.48, 0.49, 0.495, 0.499, 0.4999};
}

std::vector<report::Point> locking_points(const std::vector<double>& ratios,
                                          const report::PointFiles& files,
                                          const KeepGoing& keep_going,
                                          std::vector<LockingPoint>& results) {
  const auto key = [](const std::string& what, double ratio) {
    return fmt::format("locking-{}-{:g}-v{}", what, ratio, kLockingVersion);
  };
  results.clear();
  for (const scene::ModelFormat& format : scene::model_formats()) {
    if (format.mesh != scene::MeshKind::kLinearTetrahedra) continue;
    for (const double ratio : ratios) {
      LockingPoint& point = results.emplace_back();
      point.model = format.word;
      point.poisson_ratio = ratio;
      point.computed_poisson_ratio =
          deformation::computed_poisson_ratio(ball_scene(point.model, ratio).organs[0]);
    }
  }
  std::vector<report::Point> points;
  for (const double ratio : ratios) {
    const std::string name = key("reference", ratio) + ".csv";
    points.push_back(
        {key("reference", ratio),
         [=, &files, &results] {
           double force = 0;
           bool ignored = false;
           if (!read_point(files, name, force, ignored)) return false;
           for (LockingPoint& point : results) {
             if (point.poisson_ratio == ratio) point.reference_force = force;
           }
           return true;
         },
         [=, &files] { write_point(files, name, locking_reference(ratio, keep_going), false); }});
  }
  for (std::size_t i = 0; i < results.size(); ++i) {
    const std::string model = results[i].model;
    const double ratio = results[i].poisson_ratio;
    const std::string name = key(model, ratio) + ".csv";
    points.push_back({key(model, ratio),
                      [=, &files, &results] {
                        return read_point(files, name, results[i].force, results[i].diverged);
                      },
                      [=, &files] {
                        const auto measured = locking_point(model, ratio, keep_going);
                        write_point(files, name, measured.force, measured.diverged);
                      }});
  }
  return points;
}

void write_locking(const std::vector<LockingPoint>& points, const std::filesystem::path& file) {
  report::TableFile table(file, {"model", "poisson_ratio", "computed_poisson_ratio", "force_n",
                                 "reference_force_n", "force_error", "diverged"});
  for (const LockingPoint& p : points) {
    table.write_row(std::vector<std::string>{
        p.model, fmt::format("{:.6g}", p.poisson_ratio),
        fmt::format("{:.6g}", p.computed_poisson_ratio), fmt::format("{:.8g}", p.force),
        fmt::format("{:.8g}", p.reference_force), fmt::format("{:.6g}", p.error()),
        p.diverged ? "1" : "0"});
  }
  table.finish();
}

}  // namespace palpate::stability
