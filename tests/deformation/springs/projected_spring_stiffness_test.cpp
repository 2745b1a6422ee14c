#include "deformation/springs/projected_spring_stiffness.h"

#include <catch2/catch.hpp>
#include <random>

#include "deformation/springs/spring_forces.h"
#include "tests/deformation/organs.h"

namespace palpate::deformation {
namespace {

constexpr double kLinearisedStep = 0.01;

std::vector<Vec3> random_vectors(std::size_t count, double size, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-size, size);
  std::vector<Vec3> vectors(count);
  for (Vec3& v : vectors) v = Vec3(uniform(random), uniform(random), uniform(random));
  return vectors;
}

/// A p.
std::vector<Vec3> product(const ProjectedSpringStiffness& springs, const std::vector<Vec3>& p) {
  std::vector<Vec4f> wide_p(p.size()), wide_product(p.size());
  for (std::size_t i = 0; i < p.size(); ++i) wide_p[i] = wide(p[i]);
  springs.apply(wide_p, wide_product);
  std::vector<Vec3> out(p.size());
  for (std::size_t i = 0; i < p.size(); ++i) {
    out[i] = wide_product[i].head<3>().cast<double>();
    CHECK(wide_product[i][3] == 0);
  }
  return out;
}

double inner_product(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i].dot(b[i]);
  return sum;
}

/// The ball blown up by a tenth, so that every spring is in tension, shaken a little, and moving.
OrganState stretched_state(const OrganModel& model) {
  OrganState state = rest_state(model);
  const auto shake = random_vectors(model.node_count(), 1e-4, 1);
  for (std::size_t i = 0; i < model.node_count(); ++i) {
    state.positions[i] = 1.1 * state.positions[i] + shake[i];
  }
  state.velocities = random_vectors(model.node_count(), 0.1, 2);
  return state;
}

/// The same, squeezed: most springs pushed together.
OrganState compressed_state(const OrganModel& model) {
  OrganState state = stretched_state(model);
  for (Vec3& x : state.positions) x *= 0.8;
  return state;
}

TEST_CASE("spring linearisation: in tension A p is the finite difference of M p − h F") {
  // Oracle: finite difference of the forces along p in the velocities and h p in the positions.
  // Damping is taken along the springs as they are: velocities zero, so that it has no turning.
  const auto model = testing::ball_model(2);
  auto state = stretched_state(model);
  for (Vec3& v : state.velocities) v.setZero();
  ProjectedSpringStiffness springs(model, model.network());
  springs.linearise(state.positions, kLinearisedStep);
  const auto p = random_vectors(model.node_count(), 1, 3);
  const auto found = product(springs, p);

  const double epsilon = 1e-6;
  std::vector<Vec3> difference(model.node_count(), Vec3::Zero());
  for (const int side : {1, -1}) {
    OrganState moved = state;
    for (std::size_t i = 0; i < p.size(); ++i) {
      moved.positions[i] += side * epsilon * kLinearisedStep * p[i];
      moved.velocities[i] += side * epsilon * p[i];
    }
    std::vector<Vec3> forces(model.node_count(), Vec3::Zero());
    add_spring_forces(model.network(), moved, forces);
    for (std::size_t i = 0; i < p.size(); ++i) difference[i] += side * forces[i] / (2 * epsilon);
  }
  const double size = std::sqrt(inner_product(found, found) / static_cast<double>(p.size()));
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Vec3 expected = (1 + kLinearisedStep * model.drag) * model.masses[i] * p[i] -
                          kLinearisedStep * difference[i];
    CHECK((found[i] - expected).norm() < 2e-5 * size);  // float: lengths have 1e-6
  }
}

TEST_CASE("spring linearisation: A is symmetric, above M and below 2 D, also compressed") {
  // Oracle: invariants.
  const auto model = testing::ball_model(2);
  const auto state = compressed_state(model);
  ProjectedSpringStiffness springs(model, model.network());
  springs.linearise(state.positions, kLinearisedStep);
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const auto p = random_vectors(model.node_count(), 1, seed);
    const auto q = random_vectors(model.node_count(), 1, seed + 100);
    const auto ap = product(springs, p), aq = product(springs, q);
    CHECK(inner_product(p, aq) == Approx(inner_product(q, ap)).margin(1e-6 * inner_product(p, ap)));
    double mass = 0, diagonal = 0;
    for (std::size_t i = 0; i < p.size(); ++i) {
      mass += model.masses[i] * p[i].squaredNorm();
      diagonal += p[i].dot(springs.diagonal()[i] * p[i]);
    }
    CHECK(inner_product(p, ap) > mass);
    CHECK(inner_product(p, ap) < 2 * diagonal);
  }
}

TEST_CASE("spring linearisation: D holds the diagonal blocks of A") {
  // Oracle: A applied to unit vectors.
  const auto model = testing::ball_model(1);
  const auto state = stretched_state(model);
  ProjectedSpringStiffness springs(model, model.network());
  springs.linearise(state.positions, kLinearisedStep);
  for (const std::size_t node : {std::size_t{0}, std::size_t{17}, model.node_count() - 1}) {
    for (int axis = 0; axis < 3; ++axis) {
      std::vector<Vec3> unit(model.node_count(), Vec3::Zero());
      unit[node][axis] = 1;
      const Mat3& block = springs.diagonal()[node];
      CHECK((product(springs, unit)[node] - block.col(axis)).norm() < 1e-6 * block.norm());
    }
  }
}

TEST_CASE("spring linearisation: a common velocity strains nothing") {
  // Oracle: A 1 = (1 + h·drag) M 1.
  const auto model = testing::ball_model(2);
  const auto state = compressed_state(model);
  ProjectedSpringStiffness springs(model, model.network());
  springs.linearise(state.positions, kLinearisedStep);
  const auto found = product(springs, std::vector<Vec3>(model.node_count(), Vec3(1, 2, 3)));
  for (std::size_t i = 0; i < found.size(); ++i) {
    const Vec3 expected = (1 + kLinearisedStep * model.drag) * model.masses[i] * Vec3(1, 2, 3);
    CHECK((found[i] - expected).norm() < 1e-6 * expected.norm());
  }
}

TEST_CASE("spring linearisation: a spring without length gives nothing and no NaN") {
  // Oracle: convention of spring_forces.h.
  const auto model = testing::ball_model(1);
  auto state = rest_state(model);
  for (Vec3& x : state.positions) x.setZero();
  ProjectedSpringStiffness springs(model, model.network());
  springs.linearise(state.positions, kLinearisedStep);
  const auto p = random_vectors(model.node_count(), 1, 5);
  const auto found = product(springs, p);
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Vec3 expected = (1 + kLinearisedStep * model.drag) * model.masses[i] * p[i];
    CHECK((found[i] - expected).norm() < 1e-6 * expected.norm());
  }
}

}  // namespace
}  // namespace palpate::deformation
