#include "studies/elements/verification.h"

#include <cmath>
#include <cstdio>
#include <numbers>

#include "deformation/steppers/modal_analysis.h"
#include "modules/core/error.h"
#include "modules/geometry/tools/gmsh_tool.h"
#include "studies/elements/load_path.h"
#include "studies/report/reference_table.h"
#include "studies/rigs/indented_block.h"

namespace palpate::elements_bench {
namespace {

using namespace deformation;
using rigs::kIndenterRadius;

constexpr double kYoungsModulus = 5000, kPoissonsRatio = 0.499;
constexpr double kBallRadius = 0.05, kBallDensity = 1060;
/// ε over E / length: a traction of E penetrates by 3e-5 of the length before augmentation. A
/// hundredth of it for the small indenter.
constexpr double kPenaltyRatio = 3e4;

template <typename... Numbers>
std::string text(const char* format, Numbers... numbers) {
  char buffer[200];
  std::snprintf(buffer, sizeof buffer, format, numbers...);
  return buffer;
}

ElasticConstants tissue() { return {kYoungsModulus, kPoissonsRatio}; }

Run described(const TaylorHoodElements& solid, double size) {
  return {size, solid.mesh().nodes.size(), solid.element_count(), solid.dof_count(), {}, true};
}

/// Coordinates with `constrained(position, axis)`.
template <typename Constrained>
std::vector<char> constrained_where(const TaylorHoodElements& solid,
                                    const Constrained& constrained) {
  std::vector<char> flags;
  for (const Vec3& p : solid.mesh().nodes) {
    for (int axis = 0; axis < 3; ++axis) flags.push_back(constrained(p, axis));
  }
  return flags;
}

/// Faces with all corners where `inside(position)`.
template <typename Inside>
std::vector<std::uint32_t> faces_where(const TaylorHoodElements& solid, const Inside& inside) {
  std::vector<std::uint32_t> faces;
  const auto& mesh = solid.mesh();
  for (std::uint32_t f = 0; f < mesh.faces.size(); ++f) {
    bool all = true;
    for (int k = 0; k < 3; ++k) all = all && inside(mesh.nodes[mesh.face_node(mesh.faces[f], k)]);
    if (all) faces.push_back(f);
  }
  return faces;
}

std::size_t node_at(const TaylorHoodElements& solid, const Vec3& place) {
  const auto& nodes = solid.mesh().nodes;
  std::size_t nearest = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if ((nodes[i] - place).norm() < (nodes[nearest] - place).norm()) nearest = i;
  }
  return nearest;
}

TaylorHoodElements ball(geometry::BallPart part, const std::string& size) {
  auto mesh = make_quadratic(geometry::mesh_ball(kBallRadius, part, size));
  curve_onto_sphere(mesh, Vec3::Zero(), kBallRadius);
  return {std::move(mesh), tissue(), kBallDensity};
}

Run squeezed_ball(double size, const Setting& setting) {
  // Three times coarser in the middle, where nothing happens.
  const TaylorHoodElements solid =
      ball(geometry::BallPart::kOctant,
           text("%g - %g*(x*x+y*y+z*z)", 3 * size * kBallRadius, 2 * size / kBallRadius));
  RigidContact contact(
      solid, faces_where(solid, [](const Vec3& p) { return p.norm() > (1 - 1e-6) * kBallRadius; }),
      kPenaltyRatio * kYoungsModulus / kBallRadius);
  QuasiStaticNewton solver(
      solid, constrained_where(solid, [](const Vec3& p, int axis) { return p[axis] == 0; }),
      &contact);
  LoadPath path(solid, solver, &contact, setting);
  const std::size_t equator = node_at(solid, {kBallRadius, 0, 0});
  Run run = described(solid, size);
  const report::ReferenceTable reference(setting.reference_folder / "A_ball_plates.csv");
  for (std::size_t row = 0; row < reference.size(); ++row) {
    const double compression = reference.at("compression_d_over_2R", row);
    if (compression < 0.049 || (setting.quick && compression > 0.21)) continue;
    run.complete = path.advance_to(compression, [&](double at, SolidState&) {
      contact.set_obstacles({Plane{Vec3(0, 0, kBallRadius * (1 - at)), -Vec3::UnitZ()}});
    });
    if (!run.complete) break;
    const auto& state = path.state();
    run.rows.push_back({compression, 4 * contact.outcomes(state)[0].force.z(),
                        reference.at("F_N_nu0.499", row),
                        state.positions[equator].x() - kBallRadius,
                        1e-3 * reference.at("equatorial_radius_mm_nu0.499", row) - kBallRadius,
                        path.take_iterations()});
  }
  return run;
}

/// Beyond this compression the surface folds at the bonded edges; elements finer than this size
/// resolve the fold, and Newton's method creeps into it by ever smaller strides.
constexpr double kFolding = 0.14, kFoldingSize = 0.6;

/// The force is the sum of the held top's reactions.
Run bonded_block(double size, const Setting& setting) {
  constexpr double a = rigs::kBlockHalfWidth;
  // Stress is singular at the two bonded edges: elements shrink with the distance from them.
  const auto expression = text("%g*(0.05 + 0.95*(((x-%g)^2+(z-%g)^2)*((y-%g)^2+(z-%g)^2))^0.5/%g)",
                               size * a, a, a, a, a, a * a);
  const TaylorHoodElements solid(
      make_quadratic(geometry::mesh_block(Vec3::Zero(), Vec3::Constant(a), expression)), tissue(),
      1000);
  const auto constrained =
      constrained_where(solid, [](const Vec3& p, int axis) { return p.z() == a || p[axis] == 0; });
  QuasiStaticNewton solver(solid, constrained, nullptr);
  LoadPath path(solid, solver, nullptr, setting);
  path.set_longest_stride(0.025);
  const std::size_t face_centre = node_at(solid, {a, 0, 0});
  Run run = described(solid, size);
  const report::ReferenceTable reference(setting.reference_folder / "C_block_force_bulge.csv");
  for (std::size_t row = 0; row < reference.size(); ++row) {
    const double compression = reference.at("compression", row);
    if (setting.quick && compression > 0.1) continue;
    if (size < kFoldingSize && compression > kFolding) continue;
    run.complete = path.advance_to(compression, [&](double at, SolidState& state) {
      const double ratio = (1 - at) * a / state.positions[node_at(solid, {0, 0, a})].z();
      for (Vec3& p : state.positions) p.z() *= ratio;
    });
    if (!run.complete) break;
    const Eigen::VectorXd residual = solver.residual(path.state(), {});
    double force = 0;
    for (std::size_t i = 0; i < solid.mesh().nodes.size(); ++i) {
      if (solid.mesh().nodes[i].z() == a)
        force -= 4 * residual[static_cast<Eigen::Index>(3 * i + 2)];
    }
    run.rows.push_back(
        {compression, force, reference.at("F_N", row), path.state().positions[face_centre].x() - a,
         1e-3 * reference.at("lateral_bulge_face_centre_mm", row), path.take_iterations()});
  }
  return run;
}

Run indented_block(double size, const Setting& setting) {
  constexpr double top = rigs::kBlockHeight;
  const TaylorHoodElements solid(make_quadratic(rigs::quarter_block(size)), tissue(), 1000);
  RigidContact contact(solid,
                       faces_where(solid,
                                   [](const Vec3& p) {
                                     return p.z() == top && p.norm() < top + 3 * kIndenterRadius &&
                                            std::hypot(p.x(), p.y()) < 5 * kIndenterRadius;
                                   }),
                       kPenaltyRatio / 100 * kYoungsModulus / kIndenterRadius);
  QuasiStaticNewton solver(solid, constrained_where(solid, rigs::is_constrained_in_quarter),
                           &contact);
  LoadPath path(solid, solver, &contact, setting);
  path.set_longest_stride(0.0005);
  Run run = described(solid, size);
  const report::ReferenceTable reference(setting.reference_folder / "D_indent_force_depth.csv");
  for (std::size_t row = 0; row < reference.size(); ++row) {
    const double depth = 1e-3 * reference.at("depth_mm", row);
    if (depth < 0.99e-3 || depth > (setting.quick ? 3.01e-3 : 8.01e-3)) continue;
    run.complete = path.advance_to(depth, [&](double at, SolidState&) {
      contact.set_obstacles({Sphere{rigs::indenter_at(at), kIndenterRadius}});
    });
    if (!run.complete) break;
    run.rows.push_back({depth, 4 * contact.outcomes(path.state())[0].force.z(),
                        reference.at("F_block_N", row), 0, 0, path.take_iterations()});
  }
  return run;
}

/// Modes of one family and degree stand together; each is compared by its mean. Families nearer to
/// each other than the mesh's splitting may swap members.
Run vibrating_ball(double size, const Setting& setting) {
  const TaylorHoodElements solid = ball(geometry::BallPart::kWhole, text("%g", size * kBallRadius));
  Run run = described(solid, size);
  const report::ReferenceTable reference(setting.reference_folder / "E_ball_frequencies.csv");
  std::vector<std::size_t> wanted;  // rows
  std::size_t count = 6;            // rigid motions
  for (std::size_t row = 0; row < reference.size(); ++row) {
    if (reference.at("nu", row) != kPoissonsRatio || wanted.size() == 7) continue;
    wanted.push_back(row);
    count += static_cast<std::size_t>(reference.at("multiplicity", row));
  }
  const auto vibration = modal_analysis(solid, std::vector<char>(solid.displacement_count(), 0),
                                        count, setting.keep_going);
  std::size_t next = 6;
  for (const std::size_t row : wanted) {
    const double members = reference.at("multiplicity", row),
                 lamb = reference.at("f_Hz_Lamb_exact", row);
    double sum = 0;
    for (int k = 0; k < members; ++k) sum += vibration.angular_frequencies[next++];
    run.rows.push_back({lamb, sum / (2 * std::numbers::pi * members), lamb, 0, 0, 0});
  }
  return run;
}

}  // namespace

const std::vector<std::string>& case_names() {
  static const std::vector<std::string> kNames{"A", "C", "D", "E"};
  return kNames;
}

std::vector<double> default_sizes(const std::string& name, bool quick) {
  if (name == "A") return quick ? std::vector{0.2, 0.14} : std::vector{0.2, 0.14, 0.1};
  if (name == "C") return quick ? std::vector{1.4, 1.0} : std::vector{1.0, 0.7, 0.5};
  if (name == "D") return quick ? std::vector{0.4} : std::vector{0.4, 0.28};
  return quick ? std::vector{0.7, 0.5} : std::vector{0.7, 0.5, 0.35, 0.25};
}

Run run_case(const std::string& name, double size, const Setting& setting) {
  if (!(size > 0.01 && size <= 1.5)) {
    throw InputError("size " + std::to_string(size) + "; allowed: 0.01 to 1.5");
  }
  if (name == "A") return squeezed_ball(size, setting);
  if (name == "C") return bonded_block(size, setting);
  if (name == "D") return indented_block(size, setting);
  if (name == "E") return vibrating_ball(size, setting);
  throw InputError("case " + name + "; allowed: A, C, D, E");
}

}  // namespace palpate::elements_bench
