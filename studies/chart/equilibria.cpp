#include "studies/chart/equilibria.h"

#include <limits>
#include <stdexcept>

#include "deformation/elements/quadrature.h"
#include "modules/geometry/closest_points.h"
#include "studies/elements/load_path.h"

namespace palpate::chart {
namespace {

using deformation::SolidState;
using deformation::TaylorHoodElements;

constexpr double kStride = 0.1;        // radii, of the sphere between equilibria
constexpr int kMostHalvings = 2;       // a fold is not followed: it takes hours
constexpr double kReach = 4;           // radii: faces within may touch
constexpr double kPenaltyRatio = 300;  // as in case D of studies/elements

elements_bench::Setting quiet(const std::function<void()>& keep_going) {
  elements_bench::Setting setting;
  setting.stop = [&keep_going] {
    keep_going();
    return false;
  };
  setting.report = [](const std::string&) {};
  return setting;
}

std::vector<std::uint32_t> faces_near(const TaylorHoodElements& solid, const Vec3& place,
                                      double reach) {
  const auto& mesh = solid.mesh();
  std::vector<std::uint32_t> near;
  for (std::uint32_t f = 0; f < mesh.faces.size(); ++f) {
    if ((mesh.nodes[mesh.face_node(mesh.faces[f], 0)] - place).norm() < reach) near.push_back(f);
  }
  return near;
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

std::vector<Vec3> displacements(const TaylorHoodElements& solid, const SolidState& state,
                                const std::vector<Vec3>& marks) {
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

}  // namespace

std::vector<Pressed> press_at_rest(const TaylorHoodElements& solid, std::vector<char> constrained,
                                   const Press& press, const std::function<void()>& keep_going) {
  const auto& tissue = solid.tissue();
  deformation::RigidContact contact(solid, faces_near(solid, press.place, kReach * press.radius),
                                    kPenaltyRatio * 3 * tissue.shear_modulus() / press.radius);
  deformation::QuasiStaticNewton solver(solid, std::move(constrained), &contact);
  const auto setting = quiet(keep_going);
  elements_bench::LoadPath path(solid, solver, &contact, setting);
  path.set_longest_stride(kStride * press.radius);
  path.set_most_halvings(kMostHalvings);
  std::vector<Pressed> answers;
  for (const double depth : press.depths) {
    const bool reached = path.advance_to(depth, [&](double at, SolidState&) {
      const Vec3 centre = press.place + (at - press.radius) * press.direction;
      contact.set_obstacles({deformation::Sphere{centre, press.radius}});
    });
    if (!reached) break;
    const auto outcome = contact.outcomes(path.state())[0];
    answers.push_back(
        {-outcome.force.dot(press.direction), displacements(solid, path.state(), press.marks)});
  }
  return answers;
}

// Weight as inertia: M f (x − x̂) with x̂ = X + g/f is −M g, but for the part f |x − X|/|g|.
std::vector<Vec3> sag_at_rest(const TaylorHoodElements& solid, std::vector<char> constrained,
                              const Vec3& gravity, const std::vector<Vec3>& marks,
                              const std::function<void()>& keep_going) {
  constexpr double kFactor = 1e-3;  // f [1/s²]
  constexpr int kStrides = 8;
  deformation::QuasiStaticNewton solver(solid, std::move(constrained), nullptr);
  SolidState state = solid.rest_state();
  for (int k = 1; k <= kStrides; ++k) {
    keep_going();
    std::vector<Vec3> predicted = solid.mesh().nodes;
    for (Vec3& x : predicted) x += double(k) / kStrides / kFactor * gravity;
    if (!solver.solve(state, deformation::Inertia{kFactor, predicted}).converged) {
      throw std::runtime_error("the reference found no equilibrium under its weight");
    }
  }
  return displacements(solid, state, marks);
}

}  // namespace palpate::chart
