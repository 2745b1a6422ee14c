#include "deformation/elements/average_nodal_pressure.h"

#include <cmath>

#include "tests/deformation/elements/element_checks.h"
#include "tests/dense_algebra.h"

using namespace palpate;
using namespace palpate::deformation;
using namespace palpate::deformation::testing;

namespace {

OrganModel small_cube(double poisson_ratio) {
  return cube_model(solid_organ("nodal_pressure", poisson_ratio), Vec3::Zero(), 2);
}

}  // namespace

TEST_CASE("average nodal pressure: forces are minus the energy's gradient") {
  // Oracle: finite differences of a polynomial; nodes off by up to 3 mm of 30.
  const auto model = small_cube(0.49);
  auto elements = elements_of<AverageNodalPressure>(model);
  CHECK(force_error(elements, shaken(model, 3e-3), 1e-6) < 1e-6);
}

TEST_CASE("average nodal pressure: the matrix is the forces' derivative at rest") {
  // Oracle: finite differences; nothing is limited there but what rounding puts above the limit.
  const auto model = small_cube(0.49);
  auto elements = elements_of<AverageNodalPressure>(model);
  CHECK(matrix_error(elements, model, model.rest_positions, 0.01, 1e-6) < 1e-4);
}

TEST_CASE("average nodal pressure: the matrix stays positive however tetrahedra are deformed") {
  // Oracle: invariant. Nodes off by as much as an edge: many tetrahedra are inside out.
  const auto model = small_cube(0.5);
  auto elements = elements_of<AverageNodalPressure>(model);
  const auto p = random_velocities(model.node_count());
  std::vector<Vec4f> product(p.size());
  for (const double by : {1e-3, 1e-2, 3e-2, 0.1}) {
    auto positions = shaken(model, by);
    linearise(elements, model, positions, 0.01);
    auto direction = p;
    // Power iteration on c − A finds the least eigenvalue, with c above the largest.
    double largest = 0;
    for (const Mat3& block : elements.diagonal()) largest = std::max(largest, 30 * block.trace());
    for (int k = 0; k < 300; ++k) {
      elements.apply(direction, product);
      for (std::size_t i = 0; i < p.size(); ++i) {
        direction[i] = direction[i] - product[i] / static_cast<float>(largest);
      }
      const auto norm = static_cast<float>(std::sqrt(dot(direction, direction)));
      for (Vec4f& v : direction) v /= norm;
    }
    elements.apply(direction, product);
    CHECK(dot(direction, product) > 0);
  }
}

TEST_CASE("average nodal pressure: the matrix is no smaller than the forces' derivative") {
  // Oracle: the least eigenvalue of their difference, the derivative by finite differences of a
  // polynomial. Nodes off by up to half an edge; and all of it pressed into 0.8 of its size, where
  // pressures are many times μ.
  const auto model = small_cube(0.5);
  auto elements = elements_of<AverageNodalPressure>(model);
  for (const double size : {1.0, 0.8}) {
    for (const double by : {1e-4, 3e-3, 1.5e-2}) {
      auto positions = shaken(model, by);
      for (Vec3& x : positions) x *= size;
      const Eigen::VectorXd values =
          eigenvalues_of(excess_over_derivative(elements, model, positions, 0.02, 1e-6).excess);
      CAPTURE(size, by, values.maxCoeff());
      double largest = 0;
      for (const Mat3& block : elements.diagonal()) largest = std::max(largest, block.trace());
      CHECK(values.minCoeff() > -1e-5 * largest);  // the matrix is in float
    }
  }
}

TEST_CASE("average nodal pressure: stretched without changing volume it is neo-Hookean tissue") {
  // Oracle: analytic, F = μ A (λ − 1/λ²) with free sides; every J is 1, so that forces across are
  // those of one pressure on all of the surface, taken from the free sides.
  const auto model = cube_model(solid_organ("nodal_pressure", 0.5));
  auto elements = elements_of<AverageNodalPressure>(model);
  const double stretch = 0.7, side = 1 / std::sqrt(stretch), mu = 5e3 / 3, area = 0.06 * 0.06;
  auto positions = model.rest_positions;
  for (Vec3& x : positions) x = x.cwiseProduct(Vec3(side, side, stretch));
  linearise(elements, model, positions, 0.01);
  double along = 0, across = 0;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (model.rest_positions[i].z() > 0.0599) along -= elements.forces()[i].z();
    if (model.rest_positions[i].x() > 0.0599) across -= elements.forces()[i].x();
  }
  // Cauchy stresses along and across differ by what pressure cannot change.
  const double stress = along / (area * side * side) - across / (area * side * stretch);
  CHECK(stress * side * side == Approx(mu * (stretch - 1 / (stretch * stretch))).epsilon(1e-9));
}
