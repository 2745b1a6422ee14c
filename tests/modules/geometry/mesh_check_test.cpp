#include "modules/geometry/mesh_check.h"

#include "modules/geometry/primitives.h"
#include "tests/modules/geometry/scratch.h"

using namespace palpate;
using namespace palpate::geometry;
using namespace palpate::geometry::test;

namespace {

using Edge = std::array<std::uint32_t, 2>;

/// A ring with a square section: genus 1.
TriangleSurface square_ring(std::uint32_t segments) {
  TriangleSurface surface;
  for (std::uint32_t i = 0; i < segments; ++i) {
    const double angle = 2 * 3.14159265358979 * i / segments;
    const Vec3 out(std::cos(angle), std::sin(angle), 0);
    for (const auto& [r, z] : {std::pair{2.0, -0.5}, {3.0, -0.5}, {3.0, 0.5}, {2.0, 0.5}}) {
      surface.nodes.push_back(r * out + Vec3(0, 0, z));
    }
    const std::uint32_t here = 4 * i, there = 4 * ((i + 1) % segments);
    for (std::uint32_t k = 0; k < 4; ++k) {
      const std::uint32_t l = (k + 1) % 4;
      surface.triangles.push_back({here + k, there + k, there + l});
      surface.triangles.push_back({here + k, there + l, here + l});
    }
  }
  return surface;
}

}  // namespace

TEST_CASE("check: a sound box passes, with its measures") {
  // Oracle: analytic: volume, area, edges of 1 and √2, right isosceles triangles of aspect
  // √3/4·2/(1/2) = √3.
  const MeshReport report = check_surface(make_box({2, 2, 2}, 2));
  CHECK(report.holds_volume());
  CHECK(report.is_closed_manifold());
  CHECK(report.node_count == 26);
  CHECK(report.triangle_count == 48);
  CHECK(report.component_count == 1);
  CHECK(report.genus == 0);
  CHECK(report.volume == Approx(8).epsilon(1e-14));
  CHECK(report.area == Approx(24).epsilon(1e-14));
  CHECK(report.shortest_edge == Approx(1).epsilon(1e-14));
  CHECK(report.longest_edge == Approx(std::sqrt(2.0)).epsilon(1e-14));
  CHECK(report.worst_aspect == Approx(std::sqrt(3.0)).epsilon(1e-12));
  CHECK(report.min_corner == Vec3(-1, -1, -1));
  CHECK(report.max_corner == Vec3(1, 1, 1));
  CHECK(report.leak < 1e-15);
}

TEST_CASE("check: an equilateral triangle has aspect one") {
  // Oracle: analytic.
  CHECK(check_surface(make_tetrahedron(0.1)).worst_aspect == Approx(1).epsilon(1e-12));
}

TEST_CASE("check: a missing triangle leaves its three edges open and the leak test failing") {
  // Oracle: hand-made.
  TriangleSurface surface = make_box({1, 2, 3});
  const Triangle gone = surface.triangles.back();
  surface.triangles.pop_back();
  const MeshReport report = check_surface(surface);
  CHECK_FALSE(report.holds_volume());
  REQUIRE(report.border_edges.size() == 3);
  for (const Edge& edge : report.border_edges) {
    for (const std::uint32_t node : edge) {
      CHECK(std::find(gone.begin(), gone.end(), node) != gone.end());
    }
  }
  CHECK(report.leak > 1e-3);
}

TEST_CASE("check: a fin on an edge makes it non-manifold") {
  // Oracle: hand-made.
  TriangleSurface surface = make_tetrahedron(1);
  surface.nodes.push_back({3, 3, 3});
  surface.triangles.push_back({0, 1, 4});
  const MeshReport report = check_surface(surface);
  CHECK(report.non_manifold_edges == std::vector<Edge>{{0, 1}});
  CHECK(report.border_edges.size() == 2);
  CHECK_FALSE(report.holds_volume());
}

TEST_CASE("check: two tetrahedra touching in a node have two fans there") {
  // Oracle: hand-made: every edge is sound, only the node is not.
  TriangleSurface one = make_tetrahedron(1);
  const TriangleSurface other = moved(make_tetrahedron(1), one.nodes[0] - one.nodes[1]);
  TriangleSurface surface = one;
  // Node 1 of the other lies on node 0 of the first; its other nodes are new.
  const std::array<std::uint32_t, 4> index{4, 0, 5, 6};
  for (const int i : {0, 2, 3}) surface.nodes.push_back(other.nodes[i]);
  for (const auto& [a, b, c] : other.triangles) {
    surface.triangles.push_back({index[a], index[b], index[c]});
  }
  const MeshReport report = check_surface(surface);
  CHECK(report.border_edges.empty());
  CHECK(report.non_manifold_edges.empty());
  CHECK(report.non_manifold_nodes == std::vector<std::uint32_t>{0});
  CHECK_FALSE(report.holds_volume());
}

TEST_CASE("check: separate shells are counted") {
  // Oracle: hand-made.
  const MeshReport report = check_surface(both(make_ball(1, 1), moved(make_ball(1, 1), {5, 0, 0})));
  CHECK(report.component_count == 2);
  CHECK(report.is_closed_manifold());
  CHECK_FALSE(report.holds_volume());
}

TEST_CASE("check: a ring has genus one and holds a volume") {
  // Oracle: topology; prism volumes: area of the 12-gonal ring's plan, (n/2) sin(2π/n)(3² − 2²).
  TriangleSurface ring = square_ring(12);
  if (enclosed_volume(ring.nodes, ring.triangles) < 0) ring = inside_out(ring);
  const MeshReport report = check_surface(ring);
  CHECK(report.genus == 1);
  CHECK(report.holds_volume());
  CHECK(report.volume == Approx(15).epsilon(1e-12));
}

TEST_CASE("check: one turned triangle disagrees over its three edges") {
  // Oracle: hand-made.
  TriangleSurface surface = make_ball(1, 1);
  std::swap(surface.triangles[5][0], surface.triangles[5][1]);
  const MeshReport report = check_surface(surface);
  CHECK(report.inconsistent_edges.size() == 3);
  CHECK_FALSE(report.inside_out);
  CHECK_FALSE(report.holds_volume());
}

TEST_CASE("check: all triangles turned is inside out, not inconsistent") {
  // Oracle: hand-made.
  const MeshReport report = check_surface(inside_out(make_ball(1, 1)));
  CHECK(report.inside_out);
  CHECK(report.inconsistent_edges.empty());
  CHECK_FALSE(report.holds_volume());
}

TEST_CASE("check: degenerate, duplicate triangles and unused nodes are named") {
  // Oracle: hand-made.
  TriangleSurface surface = make_tetrahedron(1);
  surface.triangles.push_back({2, 0, 1});
  surface.triangles.push_back({3, 3, 1});
  surface.nodes.push_back({0, 0, 0});
  const MeshReport report = check_surface(surface);
  CHECK(report.duplicate_triangles == std::vector<std::uint32_t>{4});
  CHECK(report.degenerate_triangles == std::vector<std::uint32_t>{5});
  CHECK(report.unused_nodes == std::vector<std::uint32_t>{4});
  CHECK_FALSE(report.holds_volume());
}

TEST_CASE("check: a surface that passes through itself does not hold a volume") {
  // Oracle: hand-made: the tip of a tetrahedron pulled through the opposite face.
  TriangleSurface surface = make_ball(1, 2);
  for (Vec3& node : surface.nodes) {
    if (node.z() > 0.9) node.z() = -1.5;
  }
  const MeshReport report = check_surface(surface);
  CHECK(report.is_closed_manifold());
  CHECK_FALSE(report.self_intersections.empty());
  CHECK_FALSE(report.holds_volume());
}

TEST_CASE("check: nothing at all is no organ, and does not crash") {
  // Oracle: the contract.
  CHECK_FALSE(check_surface({}).holds_volume());
  CHECK_FALSE(check_surface({{Vec3::Zero()}, {}}).holds_volume());
}
