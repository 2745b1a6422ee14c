#include "deformation/steppers/xpbd_tetrahedra.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "deformation/contact/contact_solve.h"
#include "deformation/materials/volume_ratio.h"
#include "deformation/steppers/xpbd_springs.h"
#include "modules/core/error.h"

namespace palpate::deformation {
namespace {

/// ∂C/∂x of the corners from ∂C/∂F.
Mat34 by_corners(const Mat3& by_gradient, const Mat34& shapes) {
  Mat34 result;
  result.rightCols<3>() = by_gradient * shapes.rightCols<3>();
  result.col(0) = -result.rightCols<3>().rowwise().sum();
  return result;
}

}  // namespace

XpbdTetrahedra::XpbdTetrahedra(const Body& body, const TetMesh& mesh, int iterations)
    : body_(body),
      iterations_(iterations),
      law_(mesh.elastic()),
      tetrahedra_(body.rest_positions, mesh.tetrahedra),
      velocities_(body.node_count()) {
  PALPATE_DEMAND(tetrahedra_.size() > 0 && mesh.poisson_ratio < 0.5);
  largest_step_ = std::min(kStep, kStepOfBound * 2 / std::sqrt(squared_frequency_bound()));
}

double XpbdTetrahedra::squared_frequency_bound() const {
  std::vector<double> rows(body_.node_count(), 0);
  for (std::size_t e = 0; e < tetrahedra_.size(); ++e) {
    const Eigen::RowVector4d sizes = tetrahedra_.gradients[e].colwise().norm();
    for (int k = 0; k < 4; ++k) {
      rows[tetrahedra_.corners[e][static_cast<std::size_t>(k)]] +=
          law_.shear_modulus * tetrahedra_.volumes[e] * sizes[k] * sizes.sum();
    }
  }
  double bound = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    bound = std::max(bound, rows[i] * body_.inverse_masses[i]);
  }
  return bound;
}

Mat3 XpbdTetrahedra::deformation_gradient(std::size_t element,
                                          const std::vector<Vec3>& positions) const {
  const auto& [a, b, c, d] = tetrahedra_.corners[element];
  Mat3 edges;
  edges << positions[b] - positions[a], positions[c] - positions[a], positions[d] - positions[a];
  return edges * tetrahedra_.gradients[element].rightCols<3>().transpose();
}

StepReport XpbdTetrahedra::step(double h, std::span<ContactRow> rows, OrganState& state) {
  // 1. where all would fly alone; 2. tetrahedra
  inertial_prediction(body_, h, state, velocities_);
  positions_.resize(velocities_.size());
  for (std::size_t i = 0; i < positions_.size(); ++i) {
    positions_[i] = state.positions[i] + h * velocities_[i];
  }
  double stress = 0;
  multipliers_.assign(tetrahedra_.size(), {0, 0});
  for (int k = 0; k < iterations_; ++k) {
    for (std::size_t e = 0; e < tetrahedra_.size(); ++e) stress += relax(e, h);
  }

  // 3. contacts
  for (std::size_t i = 0; i < positions_.size(); ++i) {
    velocities_[i] = (positions_[i] - state.positions[i]) / h;
  }
  solve_contacts_and_volume(body_, nullptr, h, rows, velocities_, WarmStart::kToApply);

  // 4. the new state
  for (std::size_t i = 0; i < positions_.size(); ++i) {
    state.velocities[i] = velocities_[i];
    state.positions[i] += h * velocities_[i];
  }
  state.pressure = -stress / body_.rest_volume;
  return {};
}

// [∇C_i·M⁻¹∇C_j + α_ij] Δλ = −C − α λ,   Δx = M⁻¹ ∇Cᵀ Δλ
double XpbdTetrahedra::relax(std::size_t element, double h) {
  const auto& nodes = tetrahedra_.corners[element];
  const Mat34& shapes_at_rest = tetrahedra_.gradients[element];
  const double volume = tetrahedra_.volumes[element];
  const Mat3 F = deformation_gradient(element, positions_);
  const double size = F.norm();  // C_D
  if (size == 0) return 0;       // shrunk to a point: no direction to grow in
  const double shape_compliance = 1 / (law_.shear_modulus * volume * h * h);
  const double bulk_compliance = 1 / (law_.volume_modulus * volume * h * h);
  auto& [shape_multiplier, bulk_multiplier] = multipliers_[element];
  const double shape = size + shape_compliance * shape_multiplier;
  const double bulk = F.determinant() - 1 - law_.shear_modulus / law_.volume_modulus +  // C_H
                      bulk_compliance * bulk_multiplier;
  const Mat34 of_shape = by_corners(F / size, shapes_at_rest);
  const Mat34 of_bulk = by_corners(cofactor(F), shapes_at_rest);
  double shapes = shape_compliance, bulks = bulk_compliance, mixed = 0;
  for (int k = 0; k < 4; ++k) {
    const double w = body_.inverse_masses[nodes[static_cast<std::size_t>(k)]];
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
    positions_[node] += body_.inverse_masses[node] *
                        (shape_lambda * of_shape.col(k) + bulk_lambda * of_bulk.col(k));
  }
  // tr σ/3 of P = −(λ_D ∂C_D/∂F + λ_H ∂C_H/∂F)/(V h²) is P:F/(3J); J ≈ 1.
  return -(shape_lambda * size / 3 + bulk_lambda) / (h * h);
}

/// Gauss–Newton: of each tetrahedron μ V g_a·g_b I + λ/V b_a b_bᵀ, b = ∂v/∂x.
void XpbdTetrahedra::add_stiffness(const Patch& patch, Eigen::MatrixXf& sum) const {
  for (std::size_t e = 0; e < tetrahedra_.size(); ++e) {
    const auto& corners = tetrahedra_.corners[e];
    std::array<int, 4> places;
    for (std::size_t a = 0; a < 4; ++a) places[a] = patch.place(corners[a]);
    if (*std::ranges::max_element(places) < 0) continue;
    const double volume = tetrahedra_.volumes[e];
    const Mat34 areas =
        volume * cofactor(deformation_gradient(e, positions_)) * tetrahedra_.gradients[e];
    const Eigen::Matrix4d shape = tetrahedra_.gradients[e].transpose() * tetrahedra_.gradients[e];
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < 4; ++b) {
        const int i = places[static_cast<std::size_t>(a)], j = places[static_cast<std::size_t>(b)];
        if (j < 0 || j > i) continue;
        const Mat3 block = law_.shear_modulus * volume * shape(a, b) * Mat3::Identity() +
                           law_.volume_modulus / volume * areas.col(a) * areas.col(b).transpose();
        sum.block<3, 3>(3 * i, 3 * j) += block.cast<float>();
      }
    }
  }
}

double XpbdTetrahedra::elastic_energy(const OrganState& state) {
  const double rest = law_.shear_modulus * law_.shear_modulus / law_.volume_modulus;
  double energy = 0;
  for (std::size_t e = 0; e < tetrahedra_.size(); ++e) {
    const Mat3 F = deformation_gradient(e, state.positions);
    const double bulk = F.determinant() - 1 - law_.shear_modulus / law_.volume_modulus;
    energy +=
        tetrahedra_.volumes[e] / 2 *
        (law_.shear_modulus * (F.squaredNorm() - 3) + law_.volume_modulus * bulk * bulk - rest);
  }
  return energy;
}

}  // namespace palpate::deformation
