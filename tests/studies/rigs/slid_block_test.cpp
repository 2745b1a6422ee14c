#include "studies/rigs/slid_block.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "modules/geometry/tet_mesh.h"
#include "tests/modules/geometry/tetrahedra.h"

namespace palpate::rigs {
namespace {

TEST_CASE("slid block: the way lies along its direction, and small edges all along it") {
  // Oracle: by hand; the longest edge at each place of the way; a block without small edges.
  if (geometry::testing::without_gmsh()) return;
  BlockSlide slide;
  slide.direction = M_PI / 2;
  scene::Organ organ;
  organ.model = "nodal_pressure";
  const std::size_t coarse = SlidBlock(slide, organ).shape().node_count();
  slide.small = {6e-3, 0.5};
  SlidBlock block(slide, organ);
  CHECK((block.at(0.01, 3e-3) - Vec3(0, 0.01, 5e-3)).norm() < 1e-15);
  CHECK(block.shape().node_count() > 2 * coarse);
  const auto& skin = block.shape().surface;
  for (const auto& [i, j] : geometry::edges_of(skin.triangles)) {
    const Vec3 middle = (skin.nodes[i] + skin.nodes[j]) / 2;
    const bool on_way =
        std::abs(middle.x()) < 8e-3 && std::abs(middle.y()) < 25e-3 && std::abs(middle.z()) < 1e-9;
    if (on_way) CHECK((skin.nodes[i] - skin.nodes[j]).norm() <= 6e-3 * (1 + 1e-9));
  }
}

TEST_CASE("slid block: at rest the sphere is pushed up, and off the block nothing is felt") {
  // Oracle: action and reaction; on a flat block the normal is z.
  if (geometry::testing::without_gmsh()) return;
  scene::Organ organ;
  organ.model = "nodal_pressure";
  organ.tissue.drag = 40;
  SlidBlock block({}, organ);
  CHECK(block.step(block.at(0, -10e-3)) == 0);
  block.go(block.at(0, 3e-3), 20e-3);
  const Vec3 force = block.pressed().force(0);
  CHECK(force.z() > 0.05);
  CHECK(force.head<2>().norm() < 0.2 * force.z());
  CHECK(block.step(block.at(0, 3e-3)) == Approx(force.z()).epsilon(1e-3));
}

}  // namespace
}  // namespace palpate::rigs
