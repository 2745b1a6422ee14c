#include "modules/geometry/surface_transfer.h"

#include <catch2/catch.hpp>
#include <random>

#include "modules/geometry/bisection.h"
#include "modules/geometry/organ_shape.h"
#include "tests/modules/geometry/tetrahedra.h"

namespace palpate::geometry {
namespace {

OrganShape fine_about(const Vec3& centre) {
  return shape_of(bisected(
      testing::block({0.08, 0.08, 0.08}, 4, 4, 4),
      [&](const Vec3& x) { return 5e-3 + 0.6 * std::max(0.0, (x - centre).norm() - 8e-3); },
      100'000));
}

Vec3 place_at(const TriangleSurface& surface, const PlaceOnSurface& place) {
  Vec3 x = Vec3::Zero();
  for (std::size_t k = 0; k < 3; ++k) {
    x += place.weights[static_cast<Eigen::Index>(k)] *
         surface.nodes[surface.triangles[place.triangle][k]];
  }
  return x;
}

TEST_CASE("surface transfer: a place stays where it is, whichever triangle holds it") {
  // Oracle: definition. A block's edges are where faces meet at an angle.
  const OrganShape from = fine_about({0.03, 0.04, 0.08}), to = fine_about({0.045, 0.05, 0.08});
  const SurfaceTransfer transfer(from.surface.nodes, from.surface.triangles, to.surface.nodes,
                                 to.surface.triangles);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(0, 1);
  int kept = 0, moved = 0;
  for (std::uint32_t t = 0; t < from.surface.triangles.size(); ++t) {
    (transfer.triangle(t) == kNoPlace ? moved : kept)++;
    for (int i = 0; i < 5; ++i) {
      Vec3 weights(uniform(random), uniform(random), uniform(random));
      weights /= weights.sum();
      const PlaceOnSurface there = transfer.place({t, weights});
      CHECK(there.weights.minCoeff() >= 0);
      CHECK(there.weights.sum() == Approx(1));
      CHECK((place_at(to.surface, there) - place_at(from.surface, {t, weights})).norm() < 1e-15);
    }
  }
  CHECK(kept > 100);
  CHECK(moved > 100);
}

TEST_CASE("surface transfer: a node of both surfaces is found, one of the other is not") {
  // Oracle: brute force over the places of the nodes.
  const OrganShape from = fine_about({0.03, 0.04, 0.08}), to = fine_about({0.05, 0.05, 0.08});
  const SurfaceTransfer transfer(from.surface.nodes, from.surface.triangles, to.surface.nodes,
                                 to.surface.triangles);
  for (std::uint32_t i = 0; i < from.surface.nodes.size(); ++i) {
    const auto same = std::ranges::find(to.surface.nodes, from.surface.nodes[i]);
    const std::uint32_t expected =
        same == to.surface.nodes.end()
            ? kNoPlace
            : static_cast<std::uint32_t>(same - to.surface.nodes.begin());
    CHECK(transfer.node(i) == expected);
  }
}

}  // namespace
}  // namespace palpate::geometry
