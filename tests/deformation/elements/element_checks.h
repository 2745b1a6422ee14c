// What elastic force elements are tested by.
#pragma once

#include <cmath>

#include "deformation/elements/elastic_force_elements.h"
#include "deformation/elements/linear_tetrahedra.h"
#include "tests/deformation/steppers/tetrahedral_solids.h"

namespace palpate::deformation::testing {

template <class Elements>
Elements elements_of(const OrganModel& model) {
  return Elements(LinearTetrahedra(model.rest_positions, model.mesh().tetrahedra),
                  model.mesh().elastic());
}

/// For a step of h [s].
inline void linearise(ElasticForceElements& elements, const OrganModel& model,
                      const std::vector<Vec3>& positions, double h) {
  elements.linearise(positions, h * h, model.masses);
}

/// Elements that remember pressures go on from some, each resisting with another share at once.
inline void remember(ElasticForceElements& elements) {
  const auto [count, modulus, shear_modulus] = elements.pressures();
  Eigen::VectorXd kept(static_cast<Eigen::Index>(count)), shares(kept.size());
  for (Eigen::Index k = 0; k < kept.size(); ++k) {
    kept[k] = 0.3 * shear_modulus * std::sin(static_cast<double>(k));
    shares[k] = 0.1 + 0.2 * static_cast<double>(k % 5);
  }
  elements.go_on_from(kept, shares);
}

/// Largest difference of the forces from −∂U/∂x by central differences over `by`, relative to the
/// largest force, on every fifth node.
inline double force_error(ElasticForceElements& elements, const std::vector<Vec3>& positions,
                          double by) {
  elements.linearise(positions, 1, std::vector<double>(positions.size(), 1));
  const auto forces = elements.forces();
  double error = 0, largest = 0;
  auto moved = positions;
  for (std::size_t i = 0; i < positions.size(); i += 5) {
    for (int axis = 0; axis < 3; ++axis) {
      moved[i][axis] = positions[i][axis] + by;
      const double above = elements.energy(moved);
      moved[i][axis] = positions[i][axis] - by;
      const double below = elements.energy(moved);
      moved[i][axis] = positions[i][axis];
      error = std::max(error, std::abs(forces[i][axis] + (above - below) / (2 * by)));
      largest = std::max(largest, std::abs(forces[i][axis]));
    }
  }
  return error / largest;
}

inline std::vector<Vec4f> random_velocities(std::size_t count) {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> any(-1, 1);
  std::vector<Vec4f> velocities(count);
  for (Vec4f& v : velocities) v = Vec4f(any(random), any(random), any(random), 0);
  return velocities;
}

/// Largest difference of A p from M p + h² (F(x − s p) − F(x + s p))/2s, relative to the largest
/// of it.
inline double matrix_error(ElasticForceElements& elements, const OrganModel& model,
                           const std::vector<Vec3>& positions, double h, double s) {
  const auto p = random_velocities(positions.size());
  std::vector<Vec4f> product(p.size());
  linearise(elements, model, positions, h);
  elements.apply(p, product);
  auto ahead = positions, behind = positions;
  for (std::size_t i = 0; i < p.size(); ++i) {
    ahead[i] += s * p[i].head<3>().cast<double>();
    behind[i] -= s * p[i].head<3>().cast<double>();
  }
  linearise(elements, model, ahead, h);
  const auto forces_ahead = elements.forces();
  linearise(elements, model, behind, h);
  double error = 0, largest = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Vec3 expected = model.masses[i] * p[i].head<3>().cast<double>() +
                          h * h / (2 * s) * (elements.forces()[i] - forces_ahead[i]);
    error = std::max(error, (product[i].head<3>().cast<double>() - expected).norm());
    largest = std::max(largest, expected.norm());
  }
  return error / largest;
}

/// A, and what it has more than M − h² ∂f/∂x, symmetrically, the derivative by central differences
/// over `apart` [m].
struct MatrixAndExcess {
  Eigen::MatrixXd matrix, excess;
};
inline MatrixAndExcess excess_over_derivative(ElasticForceElements& elements,
                                              const OrganModel& model,
                                              const std::vector<Vec3>& positions, double h,
                                              double apart) {
  const auto n = static_cast<Eigen::Index>(3 * model.node_count());
  std::vector<Vec4f> unit(model.node_count()), product(model.node_count());
  Eigen::MatrixXd excess(n, n), matrix(n, n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const auto node = static_cast<std::size_t>(k / 3);
    const auto axis = static_cast<int>(k % 3);
    std::fill(unit.begin(), unit.end(), Vec4f::Zero());
    unit[node][axis] = 1;
    linearise(elements, model, positions, h);
    elements.apply(unit, product);
    auto moved = positions;
    moved[node][axis] += apart;
    linearise(elements, model, moved, h);
    const auto ahead = elements.forces();
    moved[node][axis] -= 2 * apart;
    linearise(elements, model, moved, h);
    for (std::size_t i = 0; i < model.node_count(); ++i) {
      const auto row = static_cast<Eigen::Index>(3 * i);
      matrix.block<3, 1>(row, k) = product[i].head<3>().cast<double>();
      excess.block<3, 1>(row, k) =
          matrix.block<3, 1>(row, k) - h * h / (2 * apart) * (elements.forces()[i] - ahead[i]);
    }
    excess(k, k) -= model.masses[node];
  }
  return {matrix, 0.5 * (excess + excess.transpose())};
}

}  // namespace palpate::deformation::testing
