#include "studies/stability/predicted_step.h"

#include <Eigen/Core>
#include <catch2/catch.hpp>

#include "deformation/springs/spring_forces.h"
#include "deformation/volume/volume_constraint.h"
#include "tests/deformation/organs.h"
#include "tests/dense_algebra.h"

namespace palpate::stability {
namespace {

using deformation::OrganModel;
using deformation::testing::ball_model;
using deformation::testing::ball_organ;

OrganModel small_ball(double damping_ratio, double drag) {
  auto organ = ball_organ();
  organ.tissue.damping_ratio = damping_ratio;
  organ.tissue.drag = drag;
  return ball_model(1, organ);
}

/// −∂F/∂x and −∂F/∂v of the plain spring forces by central differences.
struct Matrices {
  Eigen::MatrixXd stiffness, damping;
  Eigen::VectorXd masses;
};
Matrices by_differences(const OrganModel& model, const std::vector<Vec3>& positions) {
  const auto size = static_cast<Eigen::Index>(3 * model.node_count());
  Matrices result{Eigen::MatrixXd(size, size), Eigen::MatrixXd(size, size), Eigen::VectorXd(size)};
  const auto forces = [&](Eigen::Index k, double dx, double dv) {
    deformation::OrganState state = rest_state(model);
    state.positions = positions;
    state.positions[static_cast<std::size_t>(k / 3)][k % 3] += dx;
    state.velocities[static_cast<std::size_t>(k / 3)][k % 3] += dv;
    std::vector<Vec3> f(model.node_count(), Vec3::Zero());
    deformation::add_spring_forces(model.network(), state, f);
    Eigen::VectorXd flat(size);
    for (Eigen::Index i = 0; i < size; ++i) flat[i] = f[static_cast<std::size_t>(i / 3)][i % 3];
    return flat;
  };
  for (Eigen::Index k = 0; k < size; ++k) {
    constexpr double kDx = 1e-7, kDv = 1e-3;
    result.stiffness.col(k) = (forces(k, -kDx, 0) - forces(k, kDx, 0)) / (2 * kDx);
    result.damping.col(k) = (forces(k, 0, -kDv) - forces(k, 0, kDv)) / (2 * kDv);
    result.masses[k] = model.masses[static_cast<std::size_t>(k / 3)];
    result.damping(k, k) += model.drag * result.masses[k];
  }
  return result;
}

/// Projector onto g·v = 0 in coordinates √M v.
Eigen::MatrixXd volume_projector(const OrganModel& model, const std::vector<Vec3>& positions) {
  deformation::VolumeGradient volume;
  deformation::evaluate_volume(model, positions, volume);
  Eigen::VectorXd g = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(3 * model.node_count()));
  for (Eigen::Index i = 0; i < static_cast<Eigen::Index>(3 * volume.gradient.size()); ++i) {
    const auto node = static_cast<std::size_t>(i / 3);
    g[i] = volume.gradient[node][i % 3] / std::sqrt(model.masses[node]);
  }
  g.normalize();
  return Eigen::MatrixXd::Identity(g.size(), g.size()) - g * g.transpose();
}

/// The smallest h at which 4 − h² K − 2 h C, symmetric, loses definiteness, by bisection.
double by_eigenvalues(const Eigen::MatrixXd& stiffness, const Eigen::MatrixXd& damping) {
  double low = 1e-4, high = 1;
  while (high / low > 1 + 1e-6) {
    const double h = std::sqrt(low * high);
    const Eigen::MatrixXd sum = h * h * stiffness + 2 * h * damping;
    (eigenvalues_of(sum).maxCoeff() < 4 ? low : high) = h;
  }
  return low;
}

TEST_CASE("predicted step: agrees with all eigenvalues of the springs' forces by differences") {
  // Oracle: finite differences and a direct eigenvalue solver. 1e-4: the power iteration's claim.
  const bool deformed = GENERATE(false, true), damped = GENERATE(false, true),
             kept = GENERATE(false, true);
  const OrganModel model = small_ball(damped ? 0.2 : 0, damped ? 10 : 0);
  auto positions = model.rest_positions;
  if (deformed) {
    for (Vec3& p : positions) p = Vec3(1.3 * p.x() + 0.1 * p.y(), 1.1 * p.y(), 0.7 * p.z());
  }
  Matrices of = by_differences(model, positions);
  const Eigen::VectorXd scale = of.masses.cwiseSqrt().cwiseInverse();
  for (auto* matrix : {&of.stiffness, &of.damping}) {
    const Eigen::MatrixXd symmetric = (*matrix + matrix->transpose()) / 2;
    *matrix = scale.asDiagonal() * symmetric * scale.asDiagonal();
    if (!kept) continue;
    const Eigen::MatrixXd projector = volume_projector(model, positions);
    *matrix = projector * *matrix * projector;
  }
  const double direct = by_eigenvalues(of.stiffness, of.damping);
  CHECK(predicted_step(model, positions, {kept, 0}) == Approx(direct).epsilon(1e-4));
}

TEST_CASE("predicted step: stiff contents shorten it, Gershgorin's bound is on the safe side") {
  // Oracle: analytic. A pressure alone has the one squared frequency s gᵀM⁻¹g; with the springs the
  // two add up at most. Gershgorin's circles hold every eigenvalue.
  const OrganModel model = small_ball(0, 0);
  const auto& rest = model.rest_positions;
  const double springs = predicted_step(model, rest, {});
  CHECK(springs > deformation::stable_step_bound(model));
  const double stiffness = 1e9 / model.rest_volume;
  const double pressure = 2 / std::sqrt(stiffness * model.rest_denominator);
  const double both = predicted_step(model, rest, {false, stiffness});
  CHECK(both < pressure);
  CHECK(1 / (both * both) < 1 / (pressure * pressure) + 1 / (springs * springs));
}

}  // namespace
}  // namespace palpate::stability
