#include "modules/geometry/node_order.h"

#include <random>

#include "modules/geometry/mesh_check.h"
#include "modules/geometry/primitives.h"
#include "tests/modules/geometry/scratch.h"

using namespace palpate;
using namespace palpate::geometry;
using namespace palpate::geometry::test;

namespace {

TriangleSurface shuffled_ball() {
  TriangleSurface ball = make_ball(0.05, 3);
  std::vector<std::uint32_t> place(ball.nodes.size());
  for (std::uint32_t i = 0; i < place.size(); ++i) place[i] = i;
  std::mt19937 random(5);
  for (std::size_t i = place.size() - 1; i > 0; --i) std::swap(place[i], place[random() % (i + 1)]);
  TriangleSurface result = ball;
  for (std::size_t i = 0; i < place.size(); ++i) result.nodes[place[i]] = ball.nodes[i];
  for (Triangle& triangle : result.triangles) {
    for (std::uint32_t& node : triangle) node = place[node];
  }
  return result;
}

double mean_index_distance(const TriangleSurface& surface) {
  double sum = 0;
  const auto edges = edges_of(surface.triangles);
  for (const auto& [a, b] : edges) sum += b - a;
  return sum / static_cast<double>(edges.size());
}

}  // namespace

TEST_CASE("node order: the surface stays the same and neighbours get near indices") {
  // Oracle: invariants of a renumbering; a breadth-first front of N nodes is about √N wide.
  TriangleSurface surface = shuffled_ball();
  const MeshReport before = check_surface(surface);
  const double far = mean_index_distance(surface);
  order_nodes_by_neighbourhood(surface);
  const MeshReport after = check_surface(surface);
  CHECK(after.holds_volume());
  CHECK(after.node_count == before.node_count);
  CHECK(after.volume == Approx(before.volume).epsilon(1e-13));
  CHECK(after.area == Approx(before.area).epsilon(1e-13));
  CHECK(mean_index_distance(surface) < far / 4);
  CHECK(std::is_sorted(surface.triangles.begin(), surface.triangles.end()));
}

TEST_CASE("node order: several shells are all kept") {
  // Oracle: counts.
  TriangleSurface surface = both(make_ball(1, 1), moved(make_ball(1, 1), {5, 0, 0}));
  order_nodes_by_neighbourhood(surface);
  CHECK(check_surface(surface).component_count == 2);
  CHECK(check_surface(surface).unused_nodes.empty());
}
