#include "studies/chart/equilibria.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "modules/geometry/tools/gmsh_tool.h"
#include "tests/modules/geometry/tetrahedra.h"

namespace palpate::chart {
namespace {

TEST_CASE("equilibria: a beam sags by its weight as beam theory has it") {
  // Oracle: Timoshenko's beam, q L⁴/(8 E I) + q L²/(2 k G A) with k = 5/6, for a sag of 1 % of the
  // length and ν = 0, for a held end that cannot narrow is not in the theory. 2 %.
  if (geometry::testing::without_gmsh()) return;
  const double E = 200e3, nu = 0, length = 0.1, width = 0.02, g = 0.5;
  const auto mesh = geometry::mesh_block({0, -width / 2, -width / 2},
                                         {length, width / 2, width / 2}, "0.01 + 0*x");
  const deformation::TaylorHoodElements solid(deformation::make_quadratic(mesh),
                                              deformation::ElasticConstants(E, nu), 1060);
  std::vector<char> constrained;
  for (const Vec3& node : solid.mesh().nodes)
    constrained.insert(constrained.end(), 3, node.x() == 0);
  const auto moved = sag_at_rest(solid, constrained, Vec3(0, 0, -g), {{length, 0, 0}}, [] {});
  const double q = 1060 * g * width * width, G = E / (2 * (1 + nu));
  const double bending = q * std::pow(length, 4) / (8 * E * std::pow(width, 4) / 12);
  const double shear = q * length * length / (2 * 5.0 / 6 * G * width * width);
  CHECK(-moved[0].z() == Approx(bending + shear).epsilon(0.02));
}

TEST_CASE("equilibria: a sphere pressed into a block meets the force of Hertz") {
  // Oracle: Hertz, F = 4/3 E/(1−ν²) √R δ^{3/2}, for a dent small beside sphere and body. The
  // body is held 40 dents away; 10 %.
  if (geometry::testing::without_gmsh()) return;
  const double E = 5e3, nu = 0.499, radius = 5e-3, depth = 5e-4;
  const auto mesh =
      geometry::mesh_block({-0.02, -0.02, 0}, {0.02, 0.02, 0.02},
                           "0.0012 + 0.008*((x*x+y*y+(z-0.02)^2)/(x*x+y*y+(z-0.02)^2+0.0001))^2");
  const deformation::TaylorHoodElements solid(deformation::make_quadratic(mesh),
                                              deformation::ElasticConstants(E, nu), 1060);
  std::vector<char> constrained;
  for (const Vec3& node : solid.mesh().nodes)
    constrained.insert(constrained.end(), 3, node.z() == 0);
  const Press press{{0, 0, 0.02}, -Vec3::UnitZ(), radius, {depth}, {{0, 0, 0.02}}};
  const auto pressed = press_at_rest(solid, constrained, press, [] {});
  REQUIRE(pressed.size() == 1);
  const double hertz = 4.0 / 3 * E / (1 - nu * nu) * std::sqrt(radius) * std::pow(depth, 1.5);
  CHECK(pressed[0].force == Approx(hertz).epsilon(0.1));
  CHECK(pressed[0].displacements[0].z() == Approx(-depth).epsilon(0.05));
}

}  // namespace
}  // namespace palpate::chart
