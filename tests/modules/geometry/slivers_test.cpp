#include "modules/geometry/slivers.h"

#include "modules/geometry/mesh_check.h"
#include "modules/geometry/primitives.h"
#include "tests/modules/geometry/scratch.h"

using namespace palpate;
using namespace palpate::geometry;

namespace {

/// A tetrahedron with one triangle (a, b, c) cut by a node on its edge a–b, the other side of the
/// edge left whole: the gap is closed by a triangle without area.
TriangleSurface tetrahedron_with_sliver() {
  TriangleSurface surface = make_tetrahedron(1);
  const auto [a, b, c] = surface.triangles[0];
  const auto middle = static_cast<std::uint32_t>(surface.nodes.size());
  surface.nodes.push_back((surface.nodes[a] + surface.nodes[b]) / 2);
  surface.triangles[0] = {a, middle, c};
  surface.triangles.push_back({middle, b, c});
  surface.triangles.push_back({a, b, middle});
  return surface;
}

}  // namespace

TEST_CASE("slivers: a flip leaves the same solid, closed and without slivers") {
  // Oracle: invariants: volume, closedness, node count.
  TriangleSurface surface = tetrahedron_with_sliver();
  const MeshReport before = check_surface(surface);
  REQUIRE(before.border_edges.empty());
  REQUIRE(before.degenerate_triangles.size() == 1);
  CHECK(flip_slivers(surface) == 1);
  const MeshReport after = check_surface(surface);
  CHECK(after.holds_volume());
  CHECK(after.node_count == before.node_count);
  CHECK(after.volume == Approx(before.volume).epsilon(1e-14));
}

TEST_CASE("slivers: a sound surface is not touched") {
  // Oracle: identity.
  TriangleSurface surface = make_ball(0.05, 2);
  const TriangleSurface before = surface;
  CHECK(flip_slivers(surface) == 0);
  CHECK(surface.triangles == before.triangles);
}

TEST_CASE("slivers: one at an open edge stays and is reported") {
  // Oracle: hand-made, three nodes on a line beside one triangle.
  TriangleSurface surface{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 1, 3}}};
  CHECK(flip_slivers(surface) == 0);
  CHECK(check_surface(surface).degenerate_triangles == std::vector<std::uint32_t>{0});
}
