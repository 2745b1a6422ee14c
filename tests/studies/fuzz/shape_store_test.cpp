#include "studies/fuzz/shape_store.h"

#include <catch2/catch.hpp>

#include "tests/studies/fuzz/stores.h"

namespace palpate::fuzz {
namespace {

TEST_CASE("shape store: surfaces enclose volume, solids have it in their tetrahedra") {
  // Oracle: invariant; coordinates are rounded to float32, 6e-8 of them, and volumes of a flat
  // shape to some tens of that.
  for (std::size_t i = 0; i < kShapeCount; ++i) {
    const PlacedShape placed{static_cast<Shape>(i), Vec3(0.1, 0.2, 0.05)};
    CAPTURE(name_of(placed.shape));
    const auto shell = testing::shapes().shape(placed, "mass_spring");
    const auto solid = testing::shapes().shape(placed, "corotational");
    const double volume = geometry::enclosed_volume(shell.surface.nodes, shell.surface.triangles);
    double sum = 0;
    for (const auto& t : solid.tetrahedra) {
      sum += geometry::tetrahedron_volume(solid.node(t[0]), solid.node(t[1]), solid.node(t[2]),
                                          solid.node(t[3]));
    }
    CHECK_FALSE(shell.is_solid());
    CHECK(volume > 0);
    CHECK(sum == Approx(volume).epsilon(1e-5));
    CHECK_FALSE(testing::shapes().shape(placed, "modal").edge_nodes.empty());
  }
}

}  // namespace
}  // namespace palpate::fuzz
