#include "deformation/contact/enclosed_fluid.h"

#include <Eigen/LU>
#include <map>
#include <numeric>
#include <utility>

#include "deformation/elements/quadrature.h"
#include "modules/core/error.h"

namespace palpate::deformation {
namespace {

using FaceShape = Eigen::Matrix<double, kFaceNodes, 1>;

/// A face at one integration point.
struct SurfacePoint {
  FaceShape shape;
  Eigen::Matrix<double, kFaceNodes, 2> slope;
  double share = 0;  ///< of ⅓ ∫ dL₁ dL₂
  Vec3 x, along_1, along_2;
};

template <class F>
void for_surface_points(const QuadraticMesh& mesh, const BoundaryFace& face,
                        const std::vector<Vec3>& positions, const F& f) {
  Eigen::Matrix<double, 3, kFaceNodes> nodes;
  for (int k = 0; k < kFaceNodes; ++k) nodes.col(k) = positions[mesh.face_node(face, k)];
  for (const auto& [barycentric, weight] : six_point_rule()) {
    SurfacePoint at;
    at.shape = face_shape(barycentric);
    at.slope = face_shape_gradient(barycentric);
    at.share = weight / 6;
    at.x = nodes * at.shape;
    at.along_1 = nodes * at.slope.col(0);
    at.along_2 = nodes * at.slope.col(1);
    f(at);
  }
}

/// Of the space between the face and the origin, on the face's inner side [m³].
double volume_behind(const QuadraticMesh& mesh, const BoundaryFace& face,
                     const std::vector<Vec3>& positions) {
  double volume = 0;
  for_surface_points(mesh, face, positions, [&](const SurfacePoint& at) {
    volume += at.share * at.x.dot(at.along_1.cross(at.along_2));
  });
  return volume;
}

Mat3 cross_matrix(const Vec3& v) {
  Mat3 matrix;
  matrix << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return matrix;
}

std::size_t root_of(std::vector<std::size_t>& parents, std::size_t i) {
  while (parents[i] != i) i = parents[i] = parents[parents[i]];
  return i;
}

}  // namespace

EnclosedFluid::EnclosedFluid(const TaylorHoodElements& solid, std::vector<std::uint32_t> faces)
    : solid_(solid), faces_(std::move(faces)), of_element_(solid.element_count()) {
  for (const auto face : faces_) of_element_[solid.mesh().faces.at(face).element].push_back(face);
  rest_volume_ = volume(solid.rest_state());
  PALPATE_DEMAND(rest_volume_ > 0);
}

double EnclosedFluid::volume(const SolidState& state) const {
  double volume = 0;
  for (const auto face : faces_) {
    volume -= volume_behind(solid_.mesh(), solid_.mesh().faces[face], state.positions);
  }
  return volume;
}

// The triple product of x, ∂x/∂L₁, ∂x/∂L₂ is linear in each.
EnclosedFluid::FaceVector EnclosedFluid::gradient(const BoundaryFace& face,
                                                  const SolidState& state) const {
  FaceVector sum = FaceVector::Zero();
  for_surface_points(solid_.mesh(), face, state.positions, [&](const SurfacePoint& at) {
    sum += at.share * (at.along_1.cross(at.along_2) * at.shape.transpose() +
                       at.along_2.cross(at.x) * at.slope.col(0).transpose() +
                       at.x.cross(at.along_1) * at.slope.col(1).transpose());
  });
  return sum;
}

Eigen::VectorXd EnclosedFluid::gradient(const SolidState& state) const {
  const auto& mesh = solid_.mesh();
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(solid_.dof_count()));
  for (const auto f : faces_) {
    const FaceVector part = gradient(mesh.faces[f], state);
    for (int k = 0; k < kFaceNodes; ++k) {
      sum.segment<3>(Eigen::Index{3} * mesh.face_node(mesh.faces[f], k)) += part.col(k);
    }
  }
  return sum;
}

void EnclosedFluid::add_residual(std::size_t element, const SolidState& state,
                                 ElementVector& residual) const {
  for (const auto f : of_element_[element]) {
    const BoundaryFace& face = solid_.mesh().faces[f];
    const FaceVector part = gradient(face, state);
    for (int k = 0; k < kFaceNodes; ++k) {
      residual.segment<3>(Eigen::Index{3} * face.local[k]) += state.fluid_pressure * part.col(k);
    }
  }
}

void EnclosedFluid::add_tangent(std::size_t element, const SolidState& state,
                                ElementMatrix& tangent) const {
  for (const auto f : of_element_[element]) {
    const BoundaryFace& face = solid_.mesh().faces[f];
    for_surface_points(solid_.mesh(), face, state.positions, [&](const SurfacePoint& at) {
      const double factor = state.fluid_pressure * at.share;
      const Mat3 about_x = factor * cross_matrix(at.x), about_1 = factor * cross_matrix(at.along_1),
                 about_2 = factor * cross_matrix(at.along_2);
      const auto odd = [](const FaceShape& u, const FaceShape& v, int k, int l) {
        return u[k] * v[l] - v[k] * u[l];
      };
      const FaceShape n = at.shape, one = at.slope.col(0), two = at.slope.col(1);
      for (int k = 0; k < kFaceNodes; ++k) {
        for (int l = 0; l < kFaceNodes; ++l) {
          tangent.block<3, 3>(Eigen::Index{3} * face.local[k], Eigen::Index{3} * face.local[l]) +=
              about_2 * odd(one, n, k, l) + about_1 * odd(n, two, k, l) +
              about_x * odd(two, one, k, l);
        }
      }
    });
  }
}

std::vector<std::uint32_t> cavity_faces(const QuadraticMesh& mesh) {
  std::vector<std::size_t> parents(mesh.nodes.size());
  std::iota(parents.begin(), parents.end(), 0);
  for (const auto& face : mesh.faces) {
    const auto root = root_of(parents, mesh.face_node(face, 0));
    for (int k = 1; k < 3; ++k) parents[root_of(parents, mesh.face_node(face, k))] = root;
  }
  std::map<std::size_t, double> volumes;
  for (const auto& face : mesh.faces) {
    volumes[root_of(parents, mesh.face_node(face, 0))] += volume_behind(mesh, face, mesh.nodes);
  }
  std::vector<std::uint32_t> found;
  for (std::uint32_t f = 0; f < mesh.faces.size(); ++f) {
    if (volumes[root_of(parents, mesh.face_node(mesh.faces[f], 0))] < 0) found.push_back(f);
  }
  return found;
}

}  // namespace palpate::deformation
