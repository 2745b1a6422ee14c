#include "deformation/elements/quadratic_pressure.h"

#include <cmath>

#include "deformation/elements/quadrature.h"
#include "tests/deformation/elements/element_checks.h"
#include "tests/dense_algebra.h"

using namespace palpate;
using namespace palpate::deformation;
using namespace palpate::deformation::testing;

namespace {

/// Forces and products are float: seven digits, of which sums over an element's points leave six.
constexpr double kOfFloat = 1e-5;

OrganModel quadratic_cube(double poisson_ratio, int cells) {
  return cube_model(solid_organ("quadratic_pressure", poisson_ratio), Vec3::Zero(), cells);
}

QuadraticPressure quadratic_elements_of(const OrganModel& model,
                                        InstructionSet set = available_instruction_sets().back()) {
  return QuadraticPressure(model.rest_positions, model.mesh(), set);
}

/// U, point by point.
double energy_by_definition(const OrganModel& model, const std::vector<Vec3>& positions) {
  const TetMesh& mesh = model.mesh();
  const double mu = mesh.elastic().shear_modulus(), alpha = QuadraticPressure::kPointModulus * mu;
  const double kappa =
      std::min(QuadraticPressure::kLargestBulkModulus, mesh.elastic().bulk_over_shear()) * mu;
  double sum = 0;
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
    Eigen::Matrix<double, 3, kElementNodes> rest, moved;
    for (int a = 0; a < kElementNodes; ++a) {
      const auto k = static_cast<std::size_t>(a);
      const std::uint32_t node = k < 4 ? mesh.tetrahedra[e][k] : mesh.edge_nodes[e][k - 4];
      rest.col(a) = model.rest_positions[node];
      moved.col(a) = positions[node];
    }
    double growth = 0, volume = 0;
    for (const TetrahedronPoint& point : four_point_rule()) {
      const auto shape = quadratic_shape_gradient(point.barycentric);
      const Mat3 reference = rest * shape, F = moved * shape * reference.inverse();
      const double J = F.determinant();
      volume = reference.determinant() / 6;
      growth += point.weight * (J - 1);
      sum += point.weight * volume *
             (mu / 2 * (F.squaredNorm() - 3) - mu * (J - 1) + alpha / 2 * (J - 1) * (J - 1));
    }
    sum += volume * (kappa - alpha + mu / 3) / 2 * growth * growth;
  }
  return sum;
}

bool is_on_surface(const OrganModel& model, std::size_t node) {
  return node < model.surface_node_count;
}

}  // namespace

TEST_CASE(
    "quadratic pressure: energies are the definition's, of every instruction set to the bit") {
  // Oracle: the definition, straight from the rest shape; volumes and metrics are kept in float.
  const auto model = quadratic_cube(0.499, 2);
  const auto positions = shaken(model, 3e-3);
  const double expected = energy_by_definition(model, positions);
  const double found = quadratic_elements_of(model).energy(positions);
  CHECK(found == Approx(expected).epsilon(1e-6));
  for (const InstructionSet set : available_instruction_sets()) {
    CHECK(quadratic_elements_of(model, set).energy(positions) == found);
  }
}

TEST_CASE("quadratic pressure: forces are minus the energy's gradient") {
  // Oracle: finite differences of the energy, in double; nodes off by up to 3 mm of 30.
  const auto model = quadratic_cube(0.49, 2);
  auto elements = quadratic_elements_of(model);
  CHECK(force_error(elements, shaken(model, 3e-3), 1e-6) < kOfFloat);
}

TEST_CASE("quadratic pressure: the matrix is the forces' derivative at rest") {
  // Oracle: finite differences over 1e-4 m, of 3e-2: their own error is (1e-2)² of the third
  // derivative, and what float leaves of the forces, 1e-7 of them, over the 1 % they change by.
  const auto model = quadratic_cube(0.49, 2);
  auto elements = quadratic_elements_of(model);
  CHECK(matrix_error(elements, model, model.rest_positions, 0.01, 1e-4) < 5e-3);
}

TEST_CASE("quadratic pressure: the matrix goes with the share that resists at once") {
  // Oracle: finite differences, as above, of a fifth of κ' alone.
  const auto model = quadratic_cube(0.49, 2);
  auto elements = quadratic_elements_of(model);
  const auto all = static_cast<Eigen::Index>(elements.pressures().count);
  elements.go_on_from(Eigen::VectorXd::Zero(all), Eigen::VectorXd::Constant(all, 0.2));
  CHECK(matrix_error(elements, model, model.rest_positions, 0.01, 1e-4) < 5e-3);
}

TEST_CASE("quadratic pressure: what is remembered presses as the shape that had it did") {
  // Oracle: definition: forces of the shape's own pressures, all remembered but for a share, are
  // those of the shape alone.
  const auto model = quadratic_cube(0.49, 2);
  auto elements = quadratic_elements_of(model);
  const auto positions = shaken(model, 3e-3);
  linearise(elements, model, positions, 0.01);
  const auto forces = elements.forces();
  Eigen::VectorXd pressures;
  elements.take_pressures_of_shape(positions, pressures);
  const Eigen::VectorXd shares = Eigen::VectorXd::Constant(pressures.size(), 0.1);
  elements.go_on_from(0.9 * pressures, shares);
  linearise(elements, model, positions, 0.01);
  double largest = 0, error = 0;
  for (std::size_t i = 0; i < forces.size(); ++i) {
    largest = std::max(largest, forces[i].norm());
    error = std::max(error, (elements.forces()[i] - forces[i]).norm());
  }
  CHECK(error < kOfFloat * largest);
}

TEST_CASE("quadratic pressure: the matrix is symmetric, and its blocks are what it multiplies by") {
  // Oracle: unit vectors, on nodes off by up to 5 mm of 60: turnings are limited there.
  const auto model = quadratic_cube(0.5, 1);
  auto elements = quadratic_elements_of(model);
  remember(elements);
  linearise(elements, model, shaken(model, 5e-3), 0.02);
  Patch patch;
  patch.places.assign(model.node_count(), -1);
  for (std::uint32_t i = 0; i < model.node_count(); i += 2) {
    patch.places[i] = static_cast<std::int32_t>(patch.nodes.size());
    patch.nodes.push_back(i);
  }
  const auto n = static_cast<Eigen::Index>(3 * patch.nodes.size());
  Eigen::MatrixXf blocks = Eigen::MatrixXf::Zero(n, n), columns(n, n);
  elements.add_block(patch, 0.5F, blocks);
  std::vector<Vec4f> unit(model.node_count()), product(model.node_count());
  for (Eigen::Index k = 0; k < n; ++k) {
    const std::uint32_t node = patch.nodes[static_cast<std::size_t>(k / 3)];
    std::fill(unit.begin(), unit.end(), Vec4f::Zero());
    unit[node][k % 3] = 1;
    elements.apply(unit, product);
    for (std::size_t i = 0; i < patch.nodes.size(); ++i) {
      columns.block<3, 1>(static_cast<Eigen::Index>(3 * i), k) = product[patch.nodes[i]].head<3>();
    }
    const Vec3 own = product[node].head<3>().cast<double>();
    CHECK((elements.diagonal()[node].col(static_cast<int>(k % 3)) - own).norm() <
          kOfFloat * own.norm());
  }
  const float largest = columns.cwiseAbs().maxCoeff();
  CHECK((columns - columns.transpose()).cwiseAbs().maxCoeff() < kOfFloat * largest);
  const Eigen::MatrixXf lower = blocks.triangularView<Eigen::Lower>();
  const Eigen::MatrixXf expected = 0.5F * columns.triangularView<Eigen::Lower>().toDenseMatrix();
  CHECK((lower - expected).cwiseAbs().maxCoeff() < kOfFloat * largest);
}

TEST_CASE("quadratic pressure: the matrix is no smaller than the forces' derivative") {
  // Oracle: the least eigenvalue of their difference. Nodes off by up to a quarter of an edge; all
  // of it pressed into 0.8 of its size, where pressures are many times μ. Forces are float: 1e-7 of
  // them over a step of 1e-4 m in 3e-2 is 3e-5 of the matrix.
  const auto model = quadratic_cube(0.5, 1);
  auto elements = quadratic_elements_of(model);
  for (const double size : {1.0, 0.8}) {
    for (const double by : {1e-4, 3e-3, 8e-3}) {
      auto positions = shaken(model, by);
      for (Vec3& x : positions) x *= size;
      const auto [matrix, excess] = excess_over_derivative(elements, model, positions, 0.02, 1e-4);
      const double least = eigenvalues_of(excess).minCoeff();
      const double largest = matrix.cwiseAbs().maxCoeff();
      CAPTURE(size, by, least, largest);
      CHECK(least > -1e-3 * largest);
    }
  }
}

TEST_CASE("quadratic pressure: the matrix stays positive however tetrahedra are deformed") {
  // Oracle: invariant. Nodes off by as much as an edge: many points are inside out.
  const auto model = quadratic_cube(0.5, 2);
  auto elements = quadratic_elements_of(model);
  std::vector<Vec4f> product(model.node_count());
  for (const double by : {1e-3, 1e-2, 3e-2, 0.1}) {
    linearise(elements, model, shaken(model, by), 0.01);
    auto direction = random_velocities(model.node_count());
    // Power iteration on c − A finds the least eigenvalue, with c above the largest.
    double largest = 0;
    for (const Mat3& block : elements.diagonal()) largest = std::max(largest, 30 * block.trace());
    for (int k = 0; k < 300; ++k) {
      elements.apply(direction, product);
      for (std::size_t i = 0; i < direction.size(); ++i) {
        direction[i] -= product[i] / static_cast<float>(largest);
      }
      const auto norm = static_cast<float>(std::sqrt(dot(direction, direction)));
      for (Vec4f& v : direction) v /= norm;
    }
    elements.apply(direction, product);
    CHECK(dot(direction, product) > 0);
  }
}

TEST_CASE("quadratic pressure: patch test, on a distorted mesh") {
  // Oracle: under one gradient everywhere no node inside feels a force. Corners inside are off by
  // up to 4 mm of 20, middles halfway between them. Float knows J to some 2e-7, which κ = 100 μ
  // makes 2e-5 μ of pressure, of ten tetrahedra about a node.
  auto model = quadratic_cube(0.499, 3);
  const auto moved = shaken(model, 4e-3);
  auto& rest = model.rest_positions;
  for (const auto& corners : model.mesh().tetrahedra) {
    for (const auto node : corners) {
      if (!is_on_surface(model, node)) rest[node] = moved[node];
    }
  }
  for (std::size_t e = 0; e < model.mesh().tetrahedra.size(); ++e) {
    for (std::size_t k = 0; k < 6; ++k) {
      const auto& [a, b] = geometry::kTetrahedronEdges[k];
      const auto& corners = model.mesh().tetrahedra[e];
      rest[model.mesh().edge_nodes[e][k]] = (rest[corners[static_cast<std::size_t>(a)]] +
                                             rest[corners[static_cast<std::size_t>(b)]]) /
                                            2;
    }
  }
  auto elements = quadratic_elements_of(model);
  Mat3 gradient;
  gradient << 1.1, 0.2, -0.1, 0.05, 0.9, 0.1, -0.15, 0.1, 1.05;
  auto positions = rest;
  for (Vec3& x : positions) x = gradient * x;
  linearise(elements, model, positions, 0.01);
  double inside = 0, outside = 0;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    double& largest = is_on_surface(model, i) ? outside : inside;
    largest = std::max(largest, elements.forces()[i].norm());
  }
  CHECK(outside > 0);
  CHECK(inside < 5e-4 * outside);
}

TEST_CASE("quadratic pressure: forces turn with the body, and push it nowhere") {
  // Oracle: invariants. Float sees positions relative to a corner: a metre away costs nothing.
  const auto model = quadratic_cube(0.499, 2);
  auto elements = quadratic_elements_of(model);
  const auto positions = shaken(model, 3e-3);
  linearise(elements, model, positions, 0.01);
  const auto forces = elements.forces();
  const Mat3 turn = Eigen::AngleAxisd(2.0, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  auto turned = positions;
  for (Vec3& x : turned) x = turn * x + Vec3(1, -2, 3);
  linearise(elements, model, turned, 0.01);
  double largest = 0, error = 0;
  Vec3 sum = Vec3::Zero(), torque = Vec3::Zero();
  for (std::size_t i = 0; i < forces.size(); ++i) {
    largest = std::max(largest, forces[i].norm());
    error = std::max(error, (elements.forces()[i] - turn * forces[i]).norm());
    sum += forces[i];
    torque += positions[i].cross(forces[i]);
  }
  CHECK(error < kOfFloat * largest);
  CHECK(sum.norm() < kOfFloat * largest);
  CHECK(torque.norm() < kOfFloat * largest * 0.06);
}

TEST_CASE("quadratic pressure: stretched without changing volume it is neo-Hookean tissue") {
  // Oracle: analytic, F = μ A (λ − 1/λ²) with free sides; every J is 1, so that forces across are
  // those of one pressure on all of the surface, taken from the free sides.
  const auto model = quadratic_cube(0.5, 2);
  auto elements = quadratic_elements_of(model);
  const double stretch = 0.7, side = 1 / std::sqrt(stretch), mu = 5e3 / 3, area = 0.06 * 0.06;
  auto positions = model.rest_positions;
  for (Vec3& x : positions) x = x.cwiseProduct(Vec3(side, side, stretch));
  linearise(elements, model, positions, 0.01);
  double along = 0, across = 0;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (model.rest_positions[i].z() > 0.0599) along -= elements.forces()[i].z();
    if (model.rest_positions[i].x() > 0.0599) across -= elements.forces()[i].x();
  }
  // Cauchy stresses along and across differ by what pressure cannot change. κ' is 100 μ: float's
  // 1e-7 of J is 1e-5 of μ.
  const double stress = along / (area * side * side) - across / (area * side * stretch);
  CHECK(stress * side * side ==
        Approx(mu * (stretch - 1 / (stretch * stretch))).epsilon(2 * kOfFloat));
}

TEST_CASE("quadratic pressure: every instruction set gives the same bits") {
  // Oracle: the portable kernel.
  const auto model = quadratic_cube(0.499, 2);
  const auto positions = shaken(model, 5e-3);
  const auto p = random_velocities(model.node_count());
  auto portable = quadratic_elements_of(model, InstructionSet::kPortable);
  std::vector<Vec4f> expected(p.size()), product(p.size());
  Eigen::VectorXd expected_pressures, pressures;
  portable.take_pressures_of_shape(positions, expected_pressures);
  remember(portable);
  linearise(portable, model, positions, 0.01);
  portable.apply(p, expected);
  for (const InstructionSet set : available_instruction_sets()) {
    CAPTURE(name_of(set));
    auto elements = quadratic_elements_of(model, set);
    elements.take_pressures_of_shape(positions, pressures);
    CHECK(pressures == expected_pressures);
    remember(elements);
    linearise(elements, model, positions, 0.01);
    elements.apply(p, product);
    CHECK(product == expected);
    CHECK(elements.forces() == portable.forces());
    CHECK(elements.diagonal() == portable.diagonal());
  }
}
