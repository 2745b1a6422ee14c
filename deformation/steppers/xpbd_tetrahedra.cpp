#include "deformation/steppers/xpbd_tetrahedra.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "deformation/contact/contact_solve.h"
#include "deformation/materials/neo_hookean.h"
#include "deformation/steppers/xpbd_springs.h"
#include "modules/core/error.h"

namespace palpate::deformation {
namespace {

using Gradients = Eigen::Matrix<double, 3, 4>;  ///< of a constraint by its four corners

/// ∂C/∂x of the corners from ∂C/∂F.
Gradients by_corners(const Mat3& by_gradient, const Mat3& inverse_edges) {
  Gradients result;
  result.rightCols<3>() = by_gradient * inverse_edges.transpose();
  result.col(0) = -result.rightCols<3>().rowwise().sum();
  return result;
}

}  // namespace

XpbdTetrahedra::XpbdTetrahedra(const OrganModel& model, int iterations)
    : model_(model), iterations_(iterations), velocities_(model.node_count()) {
  const TetMesh& solid = model.mesh();
  PALPATE_DEMAND(!solid.tetrahedra.empty() && solid.poisson_ratio < 0.5);
  const double nu = solid.poisson_ratio;
  shear_modulus_ = solid.youngs_modulus / (2 * (1 + nu));
  lame_ = shear_modulus_ * (2 * nu / (1 - 2 * nu) + 1);
  const auto& x = model.rest_positions;
  for (const auto& [a, b, c, d] : solid.tetrahedra) {
    Mat3 edges;
    edges << x[b] - x[a], x[c] - x[a], x[d] - x[a];
    elements_.push_back({edges.inverse(), edges.determinant() / 6});
  }
  largest_step_ = std::min(kStep, kStepOfBound * 2 / std::sqrt(squared_frequency_bound()));
}

double XpbdTetrahedra::squared_frequency_bound() const {
  std::vector<double> rows(model_.node_count(), 0);
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    const Gradients shapes = by_corners(Mat3::Identity(), elements_[e].inverse_edges);
    const Eigen::RowVector4d sizes = shapes.colwise().norm();
    for (int k = 0; k < 4; ++k) {
      rows[model_.mesh().tetrahedra[e][static_cast<std::size_t>(k)]] +=
          shear_modulus_ * elements_[e].volume * sizes[k] * sizes.sum();
    }
  }
  double bound = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    bound = std::max(bound, rows[i] * model_.inverse_masses[i]);
  }
  return bound;
}

Mat3 XpbdTetrahedra::deformation_gradient(std::size_t element,
                                          const std::vector<Vec3>& positions) const {
  const auto& [a, b, c, d] = model_.mesh().tetrahedra[element];
  Mat3 edges;
  edges << positions[b] - positions[a], positions[c] - positions[a], positions[d] - positions[a];
  return edges * elements_[element].inverse_edges;
}

StepReport XpbdTetrahedra::step(double h, std::span<ContactRow> rows, OrganState& state) {
  // 1. where all would fly alone; 2. tetrahedra
  free_flight(model_, h, state, velocities_);
  positions_.resize(velocities_.size());
  for (std::size_t i = 0; i < positions_.size(); ++i) {
    positions_[i] = state.positions[i] + h * velocities_[i];
  }
  double stress = 0;
  multipliers_.assign(elements_.size(), {0, 0});
  for (int k = 0; k < iterations_; ++k) {
    for (std::size_t e = 0; e < elements_.size(); ++e) stress += relax(e, h);
  }

  // 3. contacts
  for (std::size_t i = 0; i < positions_.size(); ++i) {
    velocities_[i] = (positions_[i] - state.positions[i]) / h;
  }
  solve_contacts_and_volume(model_, nullptr, h, rows, velocities_, StartImpulses::kToApply);

  // 4. the new state
  for (std::size_t i = 0; i < positions_.size(); ++i) {
    state.velocities[i] = velocities_[i];
    state.positions[i] += h * velocities_[i];
  }
  state.pressure = -stress / model_.rest_volume;
  return {};
}

// [∇C_i·M⁻¹∇C_j + α_ij] Δλ = −C − α λ,   Δx = M⁻¹ ∇Cᵀ Δλ
double XpbdTetrahedra::relax(std::size_t element, double h) {
  const auto& nodes = model_.mesh().tetrahedra[element];
  const auto& [inverse_edges, volume] = elements_[element];
  const Mat3 F = deformation_gradient(element, positions_);
  const double size = F.norm();  // C_D
  if (size == 0) return 0;       // shrunk to a point: no direction to grow in
  const double shape_compliance = 1 / (shear_modulus_ * volume * h * h);
  const double bulk_compliance = 1 / (lame_ * volume * h * h);
  auto& [shape_multiplier, bulk_multiplier] = multipliers_[element];
  const double shape = size + shape_compliance * shape_multiplier;
  const double bulk = F.determinant() - 1 - shear_modulus_ / lame_ +  // C_H
                      bulk_compliance * bulk_multiplier;
  const Gradients of_shape = by_corners(F / size, inverse_edges);
  const Gradients of_bulk = by_corners(elements::cofactor(F), inverse_edges);
  double shapes = shape_compliance, bulks = bulk_compliance, mixed = 0;
  for (int k = 0; k < 4; ++k) {
    const double w = model_.inverse_masses[nodes[static_cast<std::size_t>(k)]];
    shapes += w * of_shape.col(k).squaredNorm();
    bulks += w * of_bulk.col(k).squaredNorm();
    mixed += w * of_shape.col(k).dot(of_bulk.col(k));
  }
  const double determinant = shapes * bulks - mixed * mixed;  // > 0 by the compliances
  const double shape_lambda = (-bulks * shape + mixed * bulk) / determinant;
  const double bulk_lambda = (mixed * shape - shapes * bulk) / determinant;
  shape_multiplier += shape_lambda;
  bulk_multiplier += bulk_lambda;
  for (int k = 0; k < 4; ++k) {
    const auto node = nodes[static_cast<std::size_t>(k)];
    positions_[node] += model_.inverse_masses[node] *
                        (shape_lambda * of_shape.col(k) + bulk_lambda * of_bulk.col(k));
  }
  // tr σ/3 of P = −(λ_D ∂C_D/∂F + λ_H ∂C_H/∂F)/(V h²) is P:F/(3J); J ≈ 1.
  return -(shape_lambda * size / 3 + bulk_lambda) / (h * h);
}

double XpbdTetrahedra::elastic_energy(const OrganState& state) {
  const double rest = shear_modulus_ * shear_modulus_ / lame_;
  double energy = 0;
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    const Mat3 F = deformation_gradient(e, state.positions);
    const double bulk = F.determinant() - 1 - shear_modulus_ / lame_;
    energy += elements_[e].volume / 2 *
              (shear_modulus_ * (F.squaredNorm() - 3) + lame_ * bulk * bulk - rest);
  }
  return energy;
}

}  // namespace palpate::deformation
