#include "deformation/steppers/quasi_static_newton.h"

#include <catch2/catch.hpp>

#include "deformation/materials/volume_ratio.h"
#include "modules/geometry/tools/gmsh_tool.h"
#include "tests/deformation/elements/solids.h"

namespace palpate::deformation {
namespace {

TEST_CASE(
    "quasi-static Newton: patch test, a distorted mesh follows a uniform deformation exactly") {
  // Oracle: F x is the solution for boundary nodes at F x, with p = κ(J−1) everywhere.
  const Vec3 size(0.02, 0.02, 0.02);
  auto mesh = testing::block(size, 3, 3, 3);
  testing::shake_interior(mesh, size, 1e-3);
  const auto solid = testing::solid(mesh, 0.3);
  Mat3 F;
  F << 1.1, 0.2, 0, 0.05, 0.9, 0.1, 0, -0.1, 1.05;
  std::vector<char> constrained(solid.displacement_count(), 0);
  auto state = solid.rest_state();
  for (std::size_t i = 0; i < state.positions.size(); ++i) {
    const Vec3& p = solid.mesh().nodes[i];
    if ((p.array() > 1e-9).all() && (p.array() < size.array() - 1e-9).all()) {
      state.positions[i] = F * p + 5e-4 * Vec3(testing::noise(i), 0.3, -0.5);
      continue;
    }
    state.positions[i] = F * p;
    for (int axis = 0; axis < 3; ++axis) constrained[3 * i + static_cast<std::size_t>(axis)] = 1;
  }
  QuasiStaticNewton solver(solid, constrained, nullptr);
  REQUIRE(solver.solve(state).converged);
  double worst = 0;
  for (std::size_t i = 0; i < state.positions.size(); ++i) {
    worst = std::max(worst, (state.positions[i] - F * solid.mesh().nodes[i]).norm());
  }
  CHECK(worst < 1e-7 * size.x());  // Newton's tolerance
  const double p = (F.determinant() - 1) / solid.tissue().inverse_bulk_modulus();
  CHECK((state.pressures.array() - p).abs().maxCoeff() < 1e-5 * std::abs(p));
}

/// Stress on the end of a bar of unit section at stretch λ, sides free: the lateral stretch by
/// bisection of P₁₁ = 0.
double uniaxial_stress(const ElasticConstants& tissue, double stretch) {
  const auto stress = [&](double lateral) {
    const Mat3 F = Vec3(lateral, lateral, stretch).asDiagonal();
    const double J = lateral * lateral * stretch;
    return Mat3(IsochoricNeoHookean(tissue).first_piola_stress(F) +
                (J - 1) / tissue.inverse_bulk_modulus() * cofactor(F));
  };
  double low = 0.5, high = 2;
  for (int i = 0; i < 100; ++i) {
    const double middle = (low + high) / 2;
    (stress(middle)(0, 0) < 0 ? low : high) = middle;
  }
  return stress(low)(2, 2);
}

TEST_CASE("quasi-static Newton: who asks it to stop is heard in the middle of a factorisation") {
  // Oracle: it asks before each iteration and for each panel of a factorisation (two at least: what
  // is eliminated, and what waits for it), and what is thrown then comes out.
  const auto solid = testing::solid(testing::block({0.02, 0.02, 0.03}, 2, 1, 2), 0.4);
  auto constrained = testing::symmetry(solid);
  auto state = solid.rest_state();
  for (std::size_t i = 0; i < state.positions.size(); ++i) {
    if (state.positions[i].z() == 0.03) constrained[3 * i + 2] = 1;
    state.positions[i].z() *= 1.1;
  }
  QuasiStaticNewton solver(solid, constrained, nullptr);
  std::size_t asked = 0;
  auto untouched = state;
  const auto report = solver.solve(untouched, {}, {}, [&] { ++asked; });
  CHECK(report.converged);
  CHECK(asked >= static_cast<std::size_t>(report.iterations + 2 * report.factorisations));
  struct Enough {};
  asked = 0;
  const auto stop = [&] {
    if (++asked == 3) throw Enough{};
  };
  CHECK_THROWS_AS(solver.solve(state, {}, {}, stop), Enough);
  CHECK(asked == 3);
}

TEST_CASE("quasi-static Newton: a block pulled and pressed carries the neo-Hookean force") {
  // Oracle: uniaxial solution, for ν = 0.5 in closed form μ(λ − λ⁻²). Uniform, so exact.
  const double nu = GENERATE(0.3, 0.4999, 0.5), stretch = GENERATE(0.6, 1.4);
  const auto solid = testing::solid(testing::block({0.02, 0.02, 0.03}, 2, 1, 2), nu);
  auto constrained = testing::symmetry(solid);
  auto state = solid.rest_state();
  for (std::size_t i = 0; i < state.positions.size(); ++i) {
    if (state.positions[i].z() == 0.03) constrained[3 * i + 2] = 1;
    state.positions[i].z() *= stretch;
  }
  QuasiStaticNewton solver(solid, constrained, nullptr);
  const auto report = solver.solve(state);
  REQUIRE(report.converged);
  const auto r = solver.residual(state, {});
  double force = 0;
  for (std::size_t i = 0; i < state.positions.size(); ++i) {
    if (solid.mesh().nodes[i].z() == 0.03) force += r[static_cast<Eigen::Index>(3 * i + 2)];
  }
  const double mu = solid.tissue().shear_modulus();
  const double stress = nu == 0.5 ? mu * (stretch - 1 / (stretch * stretch))
                                  : uniaxial_stress(solid.tissue(), stretch);
  CHECK(force == Approx(stress * 0.0004).epsilon(1e-6));
  if (nu == 0.5) CHECK(solid.volume(state) == Approx(1.2e-5).epsilon(1e-8));
}

constexpr double kInner = 0.025, kOuter = 0.05;

TaylorHoodElements thick_sphere(double size, double poisson_ratio) {
  std::string script = "SetFactory(\"OpenCASCADE\");\n";
  script += "Sphere(1) = {0, 0, 0, 0.05, 0, Pi/2, Pi/2};\n";
  script += "Sphere(2) = {0, 0, 0, 0.025, 0, Pi/2, Pi/2};\n";
  script += "BooleanDifference(3) = {Volume{1}; Delete;}{Volume{2}; Delete;};\n";
  script += "Mesh.CharacteristicLengthMax = " + std::to_string(size) + ";\n";
  auto mesh = geometry::run_gmsh(script);
  for (Vec3& p : mesh.nodes) {
    for (int i = 0; i < 3; ++i) {
      if (std::abs(p[i]) < 1e-9) p[i] = 0;
    }
  }
  auto quadratic = make_quadratic(mesh);
  curve_onto_sphere(quadratic, Vec3::Zero(), kInner);
  curve_onto_sphere(quadratic, Vec3::Zero(), kOuter);
  return {std::move(quadratic), ElasticConstants(5000, poisson_ratio), 1000};
}

TEST_CASE("quasi-static Newton: a thick sphere blown up a little follows Lamé and does not lock") {
  // Oracle: Lamé. u = A r + B/r², σ_r = 3κA − 4μB/r³, free outside; a coarse mesh, two elements
  // through the wall, within 1 %, whatever ν. Strains of 1e-4: linear.
  if (testing::without_gmsh()) return;
  const double nu = GENERATE(0.3, 0.499, 0.4999, 0.5);
  const auto solid = thick_sphere(0.013, nu);
  auto constrained = testing::symmetry(solid);
  const double grown = 1e-4 * kInner;
  auto state = solid.rest_state();
  for (std::size_t i = 0; i < state.positions.size(); ++i) {
    Vec3& p = state.positions[i];
    if (p.norm() > kInner * (1 + 1e-6)) continue;
    p *= 1 + grown / kInner;
    for (std::size_t axis = 0; axis < 3; ++axis) constrained[3 * i + axis] = 1;
  }
  QuasiStaticNewton solver(solid, constrained, nullptr);
  REQUIRE(solver.solve(state).converged);
  const auto r = solver.residual(state, {});
  double force = 0;
  Vec3 outer = Vec3::Zero();
  for (std::size_t i = 0; i < state.positions.size(); ++i) {
    const Vec3& p = solid.mesh().nodes[i];
    if (p.norm() < kInner * (1 + 1e-6) && p.x() > 0) force += r[static_cast<Eigen::Index>(3 * i)];
    if (p.norm() > kOuter * (1 - 1e-6) && p.z() > outer.z()) outer = state.positions[i];
  }
  // Nodes with x = 0 carry part of the force along x too: their residual is that of the symmetry
  // plane and left out, which costs nothing: their traction has no x component.
  const double mu = solid.tissue().shear_modulus();
  const double ratio = 4 * mu * solid.tissue().inverse_bulk_modulus() / (3 * std::pow(kOuter, 3));
  const double B = grown / (ratio * kInner + 1 / (kInner * kInner)), A = ratio * B;
  const double pressure = 4 * mu * B * (1 / std::pow(kInner, 3) - 1 / std::pow(kOuter, 3));
  CHECK(outer.norm() - kOuter == Approx(A * kOuter + B / (kOuter * kOuter)).epsilon(0.01));
  CHECK(force == Approx(pressure * 3.14159265 * kInner * kInner / 4).epsilon(0.01));
}

}  // namespace
}  // namespace palpate::deformation
