#include "deformation/contact/rigid_contact.h"

#include <algorithm>
#include <limits>

#include "deformation/elements/quadrature.h"
#include "modules/core/error.h"

namespace palpate::deformation {
namespace {

std::array<double, 6> rest_areas(const QuadraticMesh& mesh, const BoundaryFace& face) {
  std::array<double, 6> areas{};
  for (std::size_t q = 0; q < areas.size(); ++q) {
    const auto& [barycentric, weight] = six_point_rule()[q];
    const auto gradient = face_shape_gradient(barycentric);
    Eigen::Matrix<double, 3, 2> tangents = Eigen::Matrix<double, 3, 2>::Zero();
    for (int k = 0; k < kFaceNodes; ++k) {
      tangents += mesh.nodes[mesh.face_node(face, k)] * gradient.row(k);
    }
    areas[q] = weight / 2 * tangents.col(0).cross(tangents.col(1)).norm();
  }
  return areas;
}

/// @param turning  ∂(position − centre)/∂position
Gap gap_around(const Vec3& centre, double radius, const Vec3& position, const Mat3& turning) {
  const Vec3 arm = position - centre;
  const double distance = arm.norm();
  if (distance < 1e-9 * radius) return {-radius, Vec3::UnitZ(), Mat3::Zero()};
  const Vec3 normal = arm / distance;
  return {distance - radius, normal, (turning - normal * normal.transpose()) / distance};
}

/// Of μ.
constexpr double kMostBending = 4;

}  // namespace

Gap gap_at(const Obstacle& obstacle, const Vec3& position) {
  if (const auto* plane = std::get_if<Plane>(&obstacle)) {
    return {plane->normal.dot(position - plane->point), plane->normal, Mat3::Zero()};
  }
  if (const auto* sphere = std::get_if<Sphere>(&obstacle)) {
    return gap_around(sphere->centre, sphere->radius, position, Mat3::Identity());
  }
  const auto& capsule = std::get<Capsule>(obstacle);
  const Vec3 axis = capsule.b - capsule.a;
  const double along = axis.dot(position - capsule.a) / axis.squaredNorm();
  const Vec3 centre = capsule.a + std::clamp(along, 0.0, 1.0) * axis;
  const bool beside = along > 0 && along < 1;  // the centre moves along with the point
  const Mat3 turning = Mat3::Identity() - axis * axis.transpose() / axis.squaredNorm();
  return gap_around(centre, capsule.radius, position, beside ? turning : Mat3::Identity());
}

RigidContact::RigidContact(const TaylorHoodElements& solid, std::vector<std::uint32_t> faces,
                           double penalty)
    : solid_(solid), faces_(std::move(faces)), of_element_(solid.element_count()) {
  set_penalty(penalty);
  for (std::size_t c = 0; c < faces_.size(); ++c) {
    const BoundaryFace& face = solid.mesh().faces.at(faces_[c]);
    areas_.push_back(rest_areas(solid.mesh(), face));
    of_element_[face.element].push_back(c);
  }
}

void RigidContact::set_obstacles(std::vector<Obstacle> obstacles) {
  obstacles_ = std::move(obstacles);
  multipliers_.resize(obstacles_.size() * faces_.size() * kPoints, 0.0);
}

void RigidContact::set_penalty(double penalty) {
  PALPATE_DEMAND(penalty > 0);
  penalty_ = penalty;
}

void RigidContact::set_multipliers(std::vector<double> multipliers) {
  PALPATE_DEMAND(multipliers.size() == multipliers_.size());
  multipliers_ = std::move(multipliers);
}

void RigidContact::forget_multipliers() { std::ranges::fill(multipliers_, 0.0); }

Vec3 RigidContact::position(const BoundaryFace& face, int point, const SolidState& state) const {
  static const auto kShapes = [] {
    std::array<Eigen::Matrix<double, kFaceNodes, 1>, kPoints> shapes;
    for (int q = 0; q < kPoints; ++q) shapes[q] = face_shape(six_point_rule()[q].barycentric);
    return shapes;
  }();
  Vec3 x = Vec3::Zero();
  for (int k = 0; k < kFaceNodes; ++k) {
    x += kShapes[point][k] * state.positions[solid_.mesh().face_node(face, k)];
  }
  return x;
}

RigidContact::Point RigidContact::evaluate(std::size_t obstacle, std::size_t candidate, int point,
                                           const SolidState& state) const {
  const BoundaryFace& face = solid_.mesh().faces[faces_[candidate]];
  Point result{gap_at(obstacles_[obstacle], position(face, point, state))};
  const double lambda = multipliers_[index(obstacle, candidate, point)];
  result.traction = std::max(0.0, lambda - penalty_ * result.gap.gap);
  return result;
}

template <class F>
void RigidContact::for_touching(std::size_t element, const SolidState& state, const F& f) const {
  for (const std::size_t c : of_element_[element]) {
    const BoundaryFace& face = solid_.mesh().faces[faces_[c]];
    for (std::size_t o = 0; o < obstacles_.size(); ++o) {
      for (int q = 0; q < kPoints; ++q) {
        const Point at = evaluate(o, c, q, state);
        if (at.traction == 0) continue;
        f(at, areas_[c][q], face.local, face_shape(six_point_rule()[q].barycentric));
      }
    }
  }
}

void RigidContact::add_residual(std::size_t element, const SolidState& state,
                                ElementVector& residual) const {
  for_touching(element, state,
               [&](const Point& at, double area, const auto& local, const auto& shape) {
                 for (int a = 0; a < kFaceNodes; ++a) {
                   residual.segment<3>(Eigen::Index{3} * local[a]) -=
                       (area * at.traction * shape[a]) * at.gap.normal;
                 }
               });
}

void RigidContact::add_tangent(std::size_t element, const SolidState& state, ElementMatrix& tangent,
                               bool positive) const {
  // After a stride of the obstacle t is far above any stress tissue bears; taken at its word, the
  // turning of the normal would make the tangent indefinite.
  const double most_bending = positive ? kMostBending * solid_.tissue().shear_modulus()
                                       : std::numeric_limits<double>::infinity();
  for_touching(
      element, state, [&](const Point& at, double area, const auto& local, const auto& shape) {
        const double bending = std::min(at.traction, most_bending);
        const Mat3 stiffness = area * (penalty_ * at.gap.normal * at.gap.normal.transpose() -
                                       bending * at.gap.normal_derivative);
        for (int a = 0; a < kFaceNodes; ++a) {
          for (int b = 0; b < kFaceNodes; ++b) {
            tangent.block<3, 3>(Eigen::Index{3} * local[a], Eigen::Index{3} * local[b]) +=
                shape[a] * shape[b] * stiffness;
          }
        }
      });
}

void RigidContact::augment(const SolidState& state) {
  for (std::size_t o = 0; o < obstacles_.size(); ++o) {
    for (std::size_t c = 0; c < faces_.size(); ++c) {
      for (int q = 0; q < kPoints; ++q) {
        multipliers_[index(o, c, q)] = evaluate(o, c, q, state).traction;
      }
    }
  }
}

double RigidContact::deepest(const SolidState& state) const {
  double deepest = 0;
  for (const auto& outcome : outcomes(state)) deepest = std::max(deepest, outcome.deepest);
  return deepest;
}

std::vector<ContactOutcome> RigidContact::outcomes(const SolidState& state) const {
  std::vector<ContactOutcome> outcomes(obstacles_.size());
  for (std::size_t o = 0; o < obstacles_.size(); ++o) {
    for (std::size_t c = 0; c < faces_.size(); ++c) {
      for (int q = 0; q < kPoints; ++q) {
        const Point at = evaluate(o, c, q, state);
        outcomes[o].deepest = std::max(outcomes[o].deepest, -at.gap.gap);
        if (at.traction == 0) continue;
        outcomes[o].force -= areas_[c][q] * at.traction * at.gap.normal;
        ++outcomes[o].touching;
      }
    }
  }
  return outcomes;
}

}  // namespace palpate::deformation
