#include "studies/rigs/indented_block.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "modules/core/data_folder.h"
#include "modules/geometry/organ_shape.h"
#include "studies/report/reference_table.h"
#include "studies/rigs/pressed_organ.h"
#include "tests/modules/geometry/tetrahedra.h"

namespace palpate::rigs {
namespace {

scene::Organ soft_block() {
  scene::Organ organ;
  organ.name = "block";
  organ.model = "nodal_pressure";
  organ.tissue.youngs_modulus = 5e3;
  organ.tissue.density = 1060;
  organ.tissue.drag = 60;
  organ.fixed.push_back(block_base());
  return organ;
}

TEST_CASE("indented block: eight tetrahedra across the sphere carry its force, at any rate") {
  // Oracle: reference case D, missed by less than 15 %; invariant: an equilibrium does not know the
  // step, and settling lets 2e-3 through.
  if (geometry::testing::without_gmsh()) return;
  const report::ReferenceTable reference(data_file("reference/D_indent_force_depth.csv"));
  const double expected = reference.at("F_block_N", reference.row_of("depth_mm", 4));
  const auto block = geometry::shape_of(whole_block({1.2e-3, 0.02, std::sqrt(3e-4)}));
  std::vector<double> forces;
  for (const double rate : {50.0, 250.0}) {
    scene::Scene scene;
    scene.organs.push_back(soft_block());
    scene.rates.deformation = rate;
    add_indenter(scene);
    PressedOrgan pressed(scene, block, {{indenter_at(-1e-4), Quat::Identity()}});
    pressed.move_and_settle({indenter_at(4e-3)}, 0.02, [] {});
    CHECK_FALSE(pressed.diverged());
    CHECK(pressed.force(0).z() == Approx(expected).epsilon(0.15));
    forces.push_back(pressed.force(0).z());
  }
  CHECK(forces[0] == Approx(forces[1]).epsilon(2e-3));
}

TEST_CASE("indented block: the quarter is held at its base and where it is cut, nowhere else") {
  // Oracle: definition.
  for (int axis = 0; axis < 3; ++axis) {
    CHECK(is_constrained_in_quarter({0.01, 0.02, 0}, axis));
    CHECK_FALSE(is_constrained_in_quarter({0.01, 0.02, kBlockHeight}, axis));
    CHECK(is_constrained_in_quarter({0, 0, kBlockHeight}, axis) == (axis < 2));
  }
}

TEST_CASE("indented block: edges are as fine as asked for under the sphere") {
  // Oracle: the mesh's own edges.
  if (geometry::testing::without_gmsh()) return;
  const auto block = geometry::shape_of(whole_block({4e-3, 0.02, 0.02}));
  double nearest = 1;
  for (const Vec3& node : block.surface.nodes) {
    const double distance = (node - Vec3(0, 0, kBlockHeight)).norm();
    if (distance > 0) nearest = std::min(nearest, distance);
  }
  CHECK(nearest < 6e-3);
  CHECK(geometry::enclosed_volume(block.surface.nodes, block.surface.triangles) ==
        Approx(std::pow(2 * kBlockHalfWidth, 2) * kBlockHeight).epsilon(1e-9));
}

}  // namespace
}  // namespace palpate::rigs
