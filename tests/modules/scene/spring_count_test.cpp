#include "modules/scene/spring_count.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "modules/core/organ_limits.h"
#include "modules/core/temporary_folder.h"
#include "modules/geometry/mesh_io.h"
#include "modules/geometry/primitives.h"
#include "modules/scene/assets.h"

namespace palpate::scene {
namespace {

/// Two nodes, and a ring of `count` about the line between them: as many triangles meet at either.
geometry::TriangleSurface two_fans(std::uint32_t count) {
  geometry::TriangleSurface surface;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double angle = 2 * std::numbers::pi * i / count;
    surface.nodes.emplace_back(0.05 * std::cos(angle), 0.05 * std::sin(angle), 0);
    const std::uint32_t next = (i + 1) % count;
    surface.triangles.push_back({i, next, count});
    surface.triangles.push_back({next, i, count + 1});
  }
  surface.nodes.emplace_back(0, 0, 0.04);
  surface.nodes.emplace_back(0, 0, -0.04);
  return surface;
}

TEST_CASE("spring count: a surface that asks for more springs than a message holds is refused") {
  // Oracle: the pairs counted by hand. Of n nodes of the ring each two are joined: by 3 n edges,
  // those to the fans' middles among them, and n (n − 3)/2 bending springs. One joins the middles.
  const std::uint32_t n = 2826;
  const std::size_t count = 3 * n + std::size_t{n} * (n - 3) / 2 + 1;
  REQUIRE(count <= kMaxSprings);
  CHECK_NOTHROW(check_spring_count(two_fans(n), {0.1, 0, 0}));
  REQUIRE(count + n + 2 > kMaxSprings);  // with inner springs
  CHECK_THROWS_WITH(check_spring_count(two_fans(n), {0.1, 0.05, 1}),
                    Catch::Contains("more than 4000000 springs") &&
                        Catch::Contains("2826 triangles meet at its node at (0, 0, 0.04) m"));
  REQUIRE(count + n + 1 > kMaxSprings);  // what one node more adds to n
  CHECK_THROWS_WITH(check_spring_count(two_fans(n + 1), {0.1, 0, 0}),
                    Catch::Contains("2827 triangles"));
  CHECK_NOTHROW(check_spring_count(two_fans(n + 1), {0, 0.05, 1}));
  CHECK_NOTHROW(check_spring_count(geometry::make_ball(0.05, 5), {}));
}

TEST_CASE(
    "spring count: a mesh of one fan is refused by organ, file and node before it is checked") {
  // Oracle: arithmetic. Its 60,000 triangles at a node are 1.8e9 springs, and as many pairs of
  // triangles to be checked: minutes.
  const TemporaryFolder folder;
  Organ organ;
  organ.name = "liver";
  organ.mesh.file = folder.path() / "fan.ply";
  geometry::write_surface(two_fans(60'000), organ.mesh.file);
  CHECK_THROWS_WITH(load_organ(organ), Catch::Contains("organ 'liver'") &&
                                           Catch::Contains("fan.ply: its surface asks for more") &&
                                           Catch::Contains("60000 triangles meet at its node"));
}

}  // namespace
}  // namespace palpate::scene
