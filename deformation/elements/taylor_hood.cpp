#include "deformation/elements/taylor_hood.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <string>

#include "deformation/elements/quadrature.h"
#include "deformation/materials/volume_ratio.h"
#include "modules/core/error.h"

namespace palpate::deformation {
namespace {

/// ∂X/∂(L₁, L₂, L₃) at a point of the element at rest.
Mat3 reference_jacobian(const QuadraticMesh& mesh, std::size_t element,
                        const Eigen::Matrix<double, kElementNodes, 3>& shape_gradient) {
  Mat3 jacobian = Mat3::Zero();
  for (int a = 0; a < kElementNodes; ++a) {
    jacobian += mesh.nodes[mesh.elements[element][a]] * shape_gradient.row(a);
  }
  return jacobian;
}

std::array<ElementPoint, 4> rest_points(const QuadraticMesh& mesh, std::size_t element) {
  std::array<ElementPoint, 4> points;
  for (int q = 0; q < 4; ++q) {
    const auto& [barycentric, weight] = four_point_rule()[q];
    const auto shape_gradient = quadratic_shape_gradient(barycentric);
    const Mat3 jacobian = reference_jacobian(mesh, element, shape_gradient);
    const double determinant = jacobian.determinant();
    if (!(determinant > 0)) {
      throw InputError("tetrahedron " + std::to_string(element) +
                       ": flat or inside out; allowed: positive volume at every point");
    }
    points[q] = {shape_gradient * jacobian.inverse(), weight * determinant / 6};
  }
  return points;
}

Mat9 without_negative_eigenvalues(const Mat9& matrix) {
  const Eigen::SelfAdjointEigenSolver<Mat9> eigen(matrix);
  const Eigen::Matrix<double, 9, 1> values = eigen.eigenvalues().cwiseMax(0);
  return eigen.eigenvectors() * values.asDiagonal() * eigen.eigenvectors().transpose();
}

/// Σ_jl G_aj A_jl G_bl for all pairs of nodes, A in blocks of 3×3, added into the 30×30 corner.
void add_stiffness(const Eigen::Matrix<double, kElementNodes, 3>& gradient, const Mat9& A,
                   ElementMatrix& tangent) {
  for (int b = 0; b < kElementNodes; ++b) {
    const Eigen::Matrix<double, 9, 3> column = A.leftCols<3>() * gradient(b, 0) +
                                               A.middleCols<3>(3) * gradient(b, 1) +
                                               A.rightCols<3>() * gradient(b, 2);
    for (int a = b; a < kElementNodes; ++a) {
      tangent.block<3, 3>(3 * a, 3 * b) += column.topRows<3>() * gradient(a, 0) +
                                           column.middleRows<3>(3) * gradient(a, 1) +
                                           column.bottomRows<3>() * gradient(a, 2);
    }
  }
}

}  // namespace

TaylorHoodElements::TaylorHoodElements(QuadraticMesh mesh, const ElasticConstants& tissue,
                                       double density)
    : mesh_(std::move(mesh)),
      tissue_(tissue),
      law_(tissue),
      inverse_bulk_modulus_(tissue.inverse_bulk_modulus()),
      density_(density) {
  points_.reserve(element_count());
  for (std::size_t e = 0; e < element_count(); ++e) points_.push_back(rest_points(mesh_, e));
  Vec3 low = mesh_.nodes.at(0), high = low;
  for (const Vec3& p : mesh_.nodes) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  size_ = (high - low).norm();
}

std::array<int, kElementDofs> TaylorHoodElements::dofs(std::size_t element) const {
  std::array<int, kElementDofs> dofs{};
  const auto& nodes = mesh_.elements[element];
  for (int a = 0; a < kElementNodes; ++a) {
    for (int i = 0; i < 3; ++i) dofs[3 * a + i] = static_cast<int>(3 * nodes[a] + i);
  }
  for (int m = 0; m < 4; ++m) {
    dofs[30 + m] = static_cast<int>(displacement_count() + mesh_.corners[element][m]);
  }
  return dofs;
}

SolidState TaylorHoodElements::rest_state() const {
  return {mesh_.nodes, Eigen::VectorXd::Zero(static_cast<Eigen::Index>(mesh_.corner_count))};
}

Mat3 TaylorHoodElements::deformation_gradient(std::size_t element, const ElementPoint& point,
                                              const SolidState& state) const {
  Mat3 F = Mat3::Zero();
  for (int a = 0; a < kElementNodes; ++a) {
    F.noalias() += state.positions[mesh_.elements[element][a]] * point.gradient.row(a);
  }
  return F;
}

double TaylorHoodElements::pressure(std::size_t element, int point, const SolidState& state) const {
  const auto& barycentric = four_point_rule()[point].barycentric;
  double p = 0;
  for (int m = 0; m < 4; ++m) p += barycentric[m] * state.pressures[mesh_.corners[element][m]];
  return p;
}

bool TaylorHoodElements::residual(std::size_t element, const SolidState& state,
                                  ElementVector& residual) const {
  residual.setZero();
  for (int q = 0; q < 4; ++q) {
    const ElementPoint& point = points_[element][q];
    const Mat3 F = deformation_gradient(element, point, state);
    const double J = F.determinant(), p = pressure(element, q, state);
    if (!(J > 0)) return false;
    const Mat3 stress = law_.first_piola_stress(F) + p * cofactor(F);
    const Eigen::Matrix<double, 3, kElementNodes> forces =
        point.volume * stress * point.gradient.transpose();
    residual.head<30>() += forces.reshaped();
    residual.tail<4>() +=
        point.volume * (J - 1 - p * inverse_bulk_modulus_) * four_point_rule()[q].barycentric;
  }
  return true;
}

void TaylorHoodElements::tangent(std::size_t element, const SolidState& state,
                                 ElementMatrix& tangent, bool positive) const {
  tangent.setZero();
  const double inverse_bulk =
      std::max(inverse_bulk_modulus_, kLeastInverseBulk / law_.shear_modulus);
  for (int q = 0; q < 4; ++q) {
    const ElementPoint& point = points_[element][q];
    const Mat3 F = deformation_gradient(element, point, state);
    const double p = pressure(element, q, state);
    Mat9 stiffness = law_.stress_derivative(F) + p * cofactor_derivative(F);
    if (positive) stiffness = without_negative_eigenvalues(stiffness);
    add_stiffness(point.gradient, point.volume * stiffness, tangent);
    const auto& barycentric = four_point_rule()[q].barycentric;
    const Eigen::Matrix<double, 3, kElementNodes> volume_rate =
        point.volume * cofactor(F) * point.gradient.transpose();
    tangent.bottomLeftCorner<4, 30>() += barycentric * volume_rate.reshaped().transpose();
    tangent.bottomRightCorner<4, 4>() -=
        point.volume * inverse_bulk * barycentric * barycentric.transpose();
  }
  tangent.triangularView<Eigen::StrictlyUpper>() = tangent.transpose();
}

ElementMass TaylorHoodElements::mass(std::size_t element) const {
  ElementMass mass = ElementMass::Zero();
  for (const auto& [barycentric, weight] : fourteen_point_rule()) {
    const auto shape = quadratic_shape(barycentric);
    const double determinant =
        reference_jacobian(mesh_, element, quadratic_shape_gradient(barycentric)).determinant();
    mass += density_ * weight * determinant / 6 * shape * shape.transpose();
  }
  return mass;
}

double TaylorHoodElements::volume(const SolidState& state) const {
  double volume = 0;
  for (std::size_t e = 0; e < element_count(); ++e) {
    for (const ElementPoint& point : points_[e]) {
      volume += point.volume * deformation_gradient(e, point, state).determinant();
    }
  }
  return volume;
}

// At the highest p the pressure terms are worth p²/(2κ).
double TaylorHoodElements::energy(const SolidState& state) const {
  double energy = 0;
  for (std::size_t e = 0; e < element_count(); ++e) {
    for (int q = 0; q < 4; ++q) {
      const ElementPoint& point = points_[e][q];
      const double p = pressure(e, q, state);
      energy += point.volume * (law_.energy_density(deformation_gradient(e, point, state)) +
                                inverse_bulk_modulus_ * p * p / 2);
    }
  }
  return energy;
}

}  // namespace palpate::deformation
