#include "studies/truth/force_truth.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "modules/core/data_folder.h"
#include "modules/geometry/tools/gmsh_tool.h"
#include "studies/report/reference_table.h"
#include "studies/rigs/indented_block.h"
#include "tests/modules/geometry/tetrahedra.h"

namespace palpate::truth {
namespace {

Body soft_block(const geometry::TetMesh& mesh) {
  return {mesh, deformation::ElasticConstants(5e3, 0.499),
          [](const Vec3& x) { return x.z() < 1e-6; }};
}

Station ball_at(const Vec3& centre, double radius) { return {{centre, centre, radius}}; }

TEST_CASE("truth: errors that fall with any order from 1.4 up have their limit within the bar") {
  // Oracle: c hᵖ of two meshes, h and h/√2, whose limit is known.
  const Vec3 limit(1, 2, 3), error(0.02, -0.01, 0.03);
  for (const double order : {1.4, 2.0, 3.0, 4.0, 8.0}) {
    const auto found = extrapolated(limit + error, limit + std::pow(0.5, order / 2) * error);
    CHECK((found.value - limit).norm() <= found.bar);
  }
  const auto slow = extrapolated(limit + error, limit + std::pow(0.5, 1.0 / 2) * error);
  CHECK((slow.value - limit).norm() > slow.bar);
}

TEST_CASE("truth: the force of another package's solution lies within the bar, which is small") {
  // Oracle: reference case D, whose finest meshes differ by 0.2 to 0.4 %; the displacement under
  // the middle of the sphere is its depth, to the penetration that is left.
  if (geometry::testing::without_gmsh()) return;
  const report::ReferenceTable reference(data_file("reference/D_indent_force_depth.csv"));
  const double expected = reference.at("F_block_N", reference.row_of("depth_mm", 3));
  const auto body = soft_block(rigs::whole_block({0.013, 0.008, 0.02}));
  const auto at = [](double depth) {
    return ball_at(rigs::indenter_at(depth), rigs::kIndenterRadius);
  };
  const auto truths = force_truth(body, {at(-1e-4), {at(3e-3)}, {{0, 0, rigs::kBlockHeight}}}, {});
  REQUIRE(truths.size() == 1);
  const double force = truths[0].forces[0].z(), bar = truths[0].bars[0];
  INFO(force << " ± " << bar << " N, expected " << expected);
  CHECK(std::abs(force - expected) <= bar + 4e-3 * expected);
  CHECK(bar <= 0.015 * force);
  CHECK(truths[0].forces[0].head<2>().norm() <= bar);
  CHECK(truths[0].displacements[0].z() == Approx(-3e-3).margin(3e-5));
}

TEST_CASE("truth: the soft contact on the way leaves nothing at its end") {
  // Oracle: the hard contact all along, an equilibrium after each tenth of a radius. Both end where
  // no point is deeper than 1e-3 R, which is 1/3000 of the depth.
  if (geometry::testing::without_gmsh()) return;
  const auto body = soft_block(geometry::mesh_block({0, 0, 0}, {0.04, 0.04, 0.03}, "0.012 + 0*x"));
  const auto at = [](double depth) { return ball_at({0.02, 0.02, 0.036 - depth}, 6e-3); };
  const double deepest = 3e-3;
  PressedSolid soft(body.mesh, body, {at(deepest)}), hard(body.mesh, body, {at(deepest)});
  auto by_soft = soft.rest_state(), by_hard = hard.rest_state();
  REQUIRE(soft.press(at(-1e-4), at(deepest), by_soft, [] {}));
  for (int i = 1; i <= 5; ++i) REQUIRE(hard.settle(at(i * deepest / 5), by_hard));
  const Vec3 force = soft.equilibrium(by_soft, {}).forces[0];
  CHECK(force.z() > 0);
  CHECK((force - hard.equilibrium(by_hard, {}).forces[0]).norm() < 1e-3 * force.norm());
}

TEST_CASE("truth: several probes are pressed at once") {
  // Oracle: symmetry: two balls on opposite sides of a block held in its middle find the same
  // force, mirrored.
  if (geometry::testing::without_gmsh()) return;
  Body body =
      soft_block(geometry::mesh_block({-0.02, -0.02, -0.02}, {0.02, 0.02, 0.02}, "0.014 + 0*x"));
  body.is_fixed = [](const Vec3& x) { return std::abs(x.z()) < 1e-3; };
  const auto at = [](double depth) {
    const Vec3 centre(0, 0, 0.026 - depth);
    return Station{{centre, centre, 6e-3}, {-centre, -centre, 6e-3}};
  };
  const auto truths = force_truth(body, {at(0), {at(1.5e-3)}, {}}, {});
  REQUIRE(truths.size() == 1);
  const auto& [first, second] = std::pair(truths[0].forces[0], truths[0].forces[1]);
  CHECK(first.z() > 10 * truths[0].bars[0]);
  CHECK((first + second).norm() <= truths[0].bars[0] + truths[0].bars[1]);
}

}  // namespace
}  // namespace palpate::truth
