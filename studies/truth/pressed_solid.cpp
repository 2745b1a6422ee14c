#include "studies/truth/pressed_solid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "deformation/elements/quadrature.h"
#include "modules/core/error.h"
#include "modules/geometry/closest_points.h"
#include "modules/geometry/tet_mesh.h"
#include "modules/geometry/winding_number.h"

namespace palpate::truth {
namespace {

using deformation::SolidState;
using deformation::TaylorHoodElements;

constexpr double kStride = 0.2;   // radii, of the probes between equilibria
constexpr int kMostHalvings = 2;  // a fold is not followed: it takes hours
constexpr double kReach = 4;      // radii: faces within may touch
constexpr double kHard = 300;     // as in case D of studies/elements
/// Of equilibria on the way, whose penetration does not matter: a hard contact loses points and
/// catches them again in each iteration, and its tangent is hardly ever positive.
constexpr double kSoft = 3;
constexpr deformation::NewtonGoal kOnTheWay{1e-6, std::numeric_limits<double>::infinity(), true};
constexpr double kForceTolerance = 1e-7;   // of μ size²
constexpr double kMostPenetration = 1e-3;  // radii
constexpr double kAnyDensity = 1000;       // [kg/m³]: nothing moves

double distance_to_axis(const geometry::RoundedSegment& probe, const Vec3& x) {
  const Vec3 axis = probe.b - probe.a;
  if (probe.is_ball()) return (x - probe.a).norm();
  const double along = axis.dot(x - probe.a) / axis.squaredNorm();
  return (probe.a + std::clamp(along, 0.0, 1.0) * axis - x).norm();
}

double smallest_radius(const std::vector<Station>& stations) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const Station& station : stations) {
    for (const auto& probe : station) smallest = std::min(smallest, probe.radius);
  }
  PALPATE_DEMAND(std::isfinite(smallest) && smallest > 0);
  return smallest;
}

double penalty_of(double hardness, const TaylorHoodElements& solid, double radius) {
  return hardness * 3 * solid.tissue().shear_modulus() / radius;
}

std::vector<char> constrained_nodes(const geometry::TetMesh& mesh, const Body& body) {
  std::vector<char> constrained;
  for (const Vec3& node : deformation::make_quadratic(mesh).nodes) {
    constrained.insert(constrained.end(), 3, body.is_fixed(node));
  }
  return constrained;
}

/// @param cavity  faces that no probe touches, rising
std::vector<std::uint32_t> faces_near(const TaylorHoodElements& solid,
                                      const std::vector<std::uint32_t>& cavity,
                                      const std::vector<Station>& stations) {
  const auto& mesh = solid.mesh();
  const auto is_near = [&](const Vec3& x) {
    for (const Station& station : stations) {
      for (const auto& probe : station) {
        if (distance_to_axis(probe, x) < kReach * probe.radius) return true;
      }
    }
    return false;
  };
  std::vector<std::uint32_t> near;
  for (std::uint32_t f = 0; f < mesh.faces.size(); ++f) {
    if (std::ranges::binary_search(cavity, f)) continue;
    bool any = false;
    for (int k = 0; k < 3; ++k) any = any || is_near(mesh.nodes[mesh.face_node(mesh.faces[f], k)]);
    if (any) near.push_back(f);
  }
  return near;
}

std::vector<geometry::Triangle> skin_of(const TaylorHoodElements& solid,
                                        const std::vector<std::uint32_t>& cavity) {
  const auto& mesh = solid.mesh();
  std::vector<geometry::Triangle> skin;
  for (std::uint32_t f = 0; f < mesh.faces.size(); ++f) {
    if (std::ranges::binary_search(cavity, f)) continue;
    const auto& face = mesh.faces[f];
    skin.push_back({mesh.face_node(face, 0), mesh.face_node(face, 1), mesh.face_node(face, 2)});
  }
  return skin;
}

std::optional<deformation::EnclosedFluid> fluid_in(const TaylorHoodElements& solid,
                                                   const std::vector<std::uint32_t>& cavity) {
  if (cavity.empty()) return {};
  return deformation::EnclosedFluid(solid, cavity);
}

std::vector<deformation::Obstacle> obstacles_at(const Station& station) {
  std::vector<deformation::Obstacle> obstacles;
  for (const auto& probe : station) {
    if (probe.is_ball()) {
      obstacles.emplace_back(deformation::Sphere{probe.a, probe.radius});
    } else {
      obstacles.emplace_back(deformation::Capsule{probe.a, probe.b, probe.radius});
    }
  }
  return obstacles;
}

Station between(const Station& from, const Station& to, double part) {
  Station station = to;
  for (std::size_t i = 0; i < to.size(); ++i) {
    station[i].a = from[i].a + part * (to[i].a - from[i].a);
    station[i].b = from[i].b + part * (to[i].b - from[i].b);
  }
  return station;
}

/// The largest way of an end, in radii of its probe.
double way(const Station& from, const Station& to) {
  double longest = 0;
  for (std::size_t i = 0; i < to.size(); ++i) {
    longest = std::max({longest, (to[i].a - from[i].a).norm() / to[i].radius,
                        (to[i].b - from[i].b).norm() / to[i].radius});
  }
  return longest;
}

/// A point of the surface: its face and the shape functions there.
struct FacePoint {
  std::uint32_t face = 0;
  Eigen::Matrix<double, deformation::kFaceNodes, 1> shape;
};

FacePoint nearest_point(const TaylorHoodElements& solid, const Vec3& mark) {
  const auto& mesh = solid.mesh();
  FacePoint nearest;
  double least = std::numeric_limits<double>::infinity();
  for (std::uint32_t f = 0; f < mesh.faces.size(); ++f) {
    geometry::TriangleCorners corners;
    for (int k = 0; k < 3; ++k) {
      corners[static_cast<std::size_t>(k)] = mesh.nodes[mesh.face_node(mesh.faces[f], k)];
    }
    const auto closest = geometry::closest_on_triangle(mark, corners);
    const double distance = (closest.point - mark).norm();
    if (distance >= least) continue;
    least = distance;
    nearest = {f, deformation::face_shape(closest.weights)};
  }
  return nearest;
}

}  // namespace

std::vector<Vec3> displacements_at(const std::vector<Vec3>& marks, const TaylorHoodElements& solid,
                                   const SolidState& state) {
  const auto& mesh = solid.mesh();
  std::vector<Vec3> found;
  for (const Vec3& mark : marks) {
    const FacePoint point = nearest_point(solid, mark);
    Vec3& sum = found.emplace_back(Vec3::Zero());
    for (int k = 0; k < deformation::kFaceNodes; ++k) {
      const auto node = mesh.face_node(mesh.faces[point.face], k);
      sum += point.shape[k] * (state.positions[node] - mesh.nodes[node]);
    }
  }
  return found;
}

PressedSolid::PressedSolid(TaylorHoodElements solid, std::vector<char> constrained,
                           const std::vector<Station>& stations, bool is_filled)
    : solid_(std::move(solid)),
      cavity_(is_filled ? deformation::cavity_faces(solid_.mesh()) : std::vector<std::uint32_t>{}),
      skin_(skin_of(solid_, cavity_)),
      contact_(solid_, faces_near(solid_, cavity_, stations),
               penalty_of(kHard, solid_, smallest_radius(stations))),
      fluid_(fluid_in(solid_, cavity_)),
      constrained_(std::move(constrained)),
      solver_(solid_, constrained_, &contact_, fluid_ ? &*fluid_ : nullptr),
      radius_(smallest_radius(stations)) {}

PressedSolid::PressedSolid(const geometry::TetMesh& mesh, const Body& body,
                           const std::vector<Station>& stations)
    : PressedSolid({deformation::make_quadratic(mesh), body.tissue, kAnyDensity},
                   constrained_nodes(mesh, body), stations, body.is_filled) {}

void PressedSolid::set_hardness(double hardness) {
  contact_.set_penalty(penalty_of(hardness, solid_, radius_));
}

bool PressedSolid::press(const Station& from, const Station& to, SolidState& state,
                         const std::function<void()>& keep_going,
                         const std::function<void(double)>& at) {
  const SolidState before = state;
  contact_.set_obstacles(obstacles_at(from));
  auto multipliers = contact_.multipliers();
  contact_.forget_multipliers();
  if (follow(from, to, kSoft, state, keep_going, at) && settle(to, state, keep_going)) return true;
  state = before;
  contact_.set_multipliers(std::move(multipliers));
  const auto is_told_already = [](double) {};
  return follow(from, to, kHard, state, keep_going, is_told_already) &&
         settle(to, state, keep_going);
}

bool PressedSolid::follow(const Station& from, const Station& to, double hardness,
                          SolidState& state, const std::function<void()>& keep_going,
                          const std::function<void(double)>& at) {
  set_hardness(hardness);
  const double longest = kStride / way(from, to);
  double done = 0, stride = longest, last = 0;
  SolidState before = state;
  while (done < 1) {
    const double next = done + stride * (1 + 1e-9) >= 1 ? 1 : done + stride;
    contact_.set_obstacles(obstacles_at(between(from, to, next)));
    const double beyond = last > 0 ? (next - done) / last : 0;
    SolidState found = state;
    for (std::size_t i = 0; i < found.positions.size(); ++i) {
      found.positions[i] += beyond * (state.positions[i] - before.positions[i]);
    }
    found.pressures += beyond * (state.pressures - before.pressures);
    found.fluid_pressure += beyond * (state.fluid_pressure - before.fluid_pressure);
    auto report = solver_.solve(found, {}, kOnTheWay, keep_going);
    if (!report.converged && beyond > 0) {
      found = state;
      report = solver_.solve(found, {}, kOnTheWay, keep_going);
    }
    if (report.converged) {
      before = std::exchange(state, std::move(found));
      last = next - done;
      done = next;
      at(done);
      continue;
    }
    stride = std::min(stride, next - done) / 2;
    last = 0;
    if (stride < std::ldexp(longest, -kMostHalvings)) return false;
  }
  return true;
}

bool PressedSolid::settle(const Station& station, SolidState& state,
                          const std::function<void()>& keep_going) {
  contact_.set_obstacles(obstacles_at(station));
  set_hardness(kHard);
  const deformation::NewtonGoal goal{kForceTolerance, kMostPenetration * radius_ / solid_.size(),
                                     true};
  return solver_.solve(state, {}, goal, keep_going).converged && !is_behind_skin(station, state);
}

/// Walls are thin, and only faces resist: a probe that came through one is felt no more.
bool PressedSolid::is_behind_skin(const Station& station, const SolidState& state) const {
  return std::ranges::any_of(station, [&](const geometry::RoundedSegment& probe) {
    const Vec3 places[] = {probe.a, (probe.a + probe.b) / 2, probe.b};
    return std::ranges::any_of(places, [&](const Vec3& place) {
      return std::abs(geometry::winding_number(place, state.positions, skin_)) > 0.5;
    });
  });
}

Equilibrium PressedSolid::equilibrium(const SolidState& state,
                                      const std::vector<Vec3>& marks) const {
  Equilibrium found;
  for (const auto& outcome : contact_.outcomes(state)) found.forces.push_back(outcome.force);
  found.displacements = displacements_at(marks, solid_, state);
  return found;
}

// Each element lies in one element of the coarser mesh, whose functions are looked at.
SolidState PressedSolid::refined(const PressedSolid& coarser, const SolidState& state) const {
  const auto &fine = solid_.mesh(), &coarse = coarser.solid_.mesh();
  SolidState result = rest_state();
  result.fluid_pressure = state.fluid_pressure;
  std::vector<Eigen::Matrix4d> to_barycentric;
  for (const auto& element : coarse.elements) {
    Eigen::Matrix4d corners = Eigen::Matrix4d::Ones();
    for (int a = 0; a < 4; ++a) corners.block<3, 1>(0, a) = coarse.nodes[element[a]];
    to_barycentric.push_back(corners.inverse());
  }
  for (std::size_t e = 0; e < fine.elements.size(); ++e) {
    const auto& element = fine.elements[e];
    Vec3 middle = Vec3::Zero();
    for (int a = 0; a < 4; ++a) middle += fine.nodes[element[a]] / 4;
    std::size_t host = 0;
    double most = -std::numeric_limits<double>::infinity();
    for (std::size_t c = 0; c < coarse.elements.size(); ++c) {
      const double least = (to_barycentric[c] * middle.homogeneous()).minCoeff();
      if (least > most) most = least, host = c;
    }
    for (int a = 0; a < deformation::kElementNodes; ++a) {
      const Eigen::Vector4d at = to_barycentric[host] * fine.nodes[element[a]].homogeneous();
      const auto shape = deformation::quadratic_shape(at);
      Vec3 position = Vec3::Zero();
      for (int b = 0; b < deformation::kElementNodes; ++b) {
        position += shape[b] * state.positions[coarse.elements[host][b]];
      }
      result.positions[element[a]] = position;
      if (a >= 4) continue;
      double pressure = 0;
      for (int b = 0; b < 4; ++b) pressure += at[b] * state.pressures[coarse.corners[host][b]];
      result.pressures[fine.corners[e][a]] = pressure;
    }
  }
  for (std::size_t i = 0; i < constrained_.size(); i += 3) {
    if (constrained_[i]) result.positions[i / 3] = fine.nodes[i / 3];
  }
  return result;
}

}  // namespace palpate::truth
