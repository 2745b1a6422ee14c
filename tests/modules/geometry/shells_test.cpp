#include "modules/geometry/shells.h"

#include <catch2/catch.hpp>

#include "modules/geometry/mesh_check.h"
#include "modules/geometry/primitives.h"

namespace palpate::geometry {
namespace {

void append(const TriangleSurface& part, const Vec3& by, TriangleSurface& whole) {
  const auto first = static_cast<std::uint32_t>(whole.nodes.size());
  for (const Vec3& node : part.nodes) whole.nodes.push_back(node + by);
  for (const auto& [a, b, c] : part.triangles) {
    whole.triangles.push_back({first + a, first + b, first + c});
  }
}

TEST_CASE("shells: a ball in a ball and one beside it are three, the largest first") {
  // Oracle: the balls they were made of.
  const TriangleSurface small = make_ball(0.01, 2), middle = make_ball(0.02, 2),
                        large = make_ball(0.05, 3);
  TriangleSurface whole;
  append(small, Vec3::Zero(), whole);
  append(large, Vec3::Zero(), whole);
  append(middle, Vec3(0.2, 0, 0), whole);
  const auto shells = shells_of(whole);
  REQUIRE(shells.size() == 3);
  CHECK(shells[0].nodes.size() == large.nodes.size());
  CHECK(shells[0].triangles.size() == large.triangles.size());
  CHECK(shells[1].nodes.size() == middle.nodes.size());
  CHECK(shells[2].nodes.size() == small.nodes.size());
  for (const auto& shell : shells) CHECK(check_surface(shell).holds_volume());
  CHECK(shells_of(large).size() == 1);
  CHECK(shells_of(large)[0].triangles == large.triangles);
}

TEST_CASE("shells: holes of one and of many triangles are closed, and the ball holds a volume") {
  // Oracle: the mesh check, and the volume of the ball before it was opened.
  const TriangleSurface ball = make_ball(0.05, 3);
  const double volume = enclosed_volume(ball.nodes, ball.triangles);
  TriangleSurface open = ball;
  open.triangles.erase(open.triangles.begin() + 700);
  std::erase_if(open.triangles, [&](const Triangle& t) { return ball.nodes[t[0]].z() > 0.045; });
  REQUIRE_FALSE(check_surface(open).holds_volume());
  CHECK(fill_holes(open) == 2);
  const MeshReport report = check_surface(open);
  CHECK(report.border_edges.empty());
  CHECK(report.inconsistent_edges.empty());
  // What was cut off is a cap of height 5 mm and more of a radius of 50 mm: 2.5 % at most.
  CHECK(enclosed_volume(open.nodes, open.triangles) == Approx(volume).epsilon(0.025));
  TriangleSurface closed = ball;
  CHECK(fill_holes(closed) == 0);
  CHECK(closed.triangles == ball.triangles);
}

TEST_CASE("shells: two holes that meet in a node are left as they are, or closed, never worse") {
  // Oracle: the count of open edges.
  TriangleSurface ball = make_ball(0.05, 2);
  const std::uint32_t shared = ball.triangles[0][0];
  int removed = 0;
  std::vector<Triangle> kept;
  int seen = 0;
  for (const Triangle& t : ball.triangles) {
    const bool has = t[0] == shared || t[1] == shared || t[2] == shared;
    if (has && seen++ % 3 == 0 && removed < 2) {
      ++removed;
      continue;
    }
    kept.push_back(t);
  }
  ball.triangles = kept;
  const std::size_t open = check_surface(ball).border_edges.size();
  fill_holes(ball);
  CHECK(check_surface(ball).border_edges.size() <= open);
}

}  // namespace
}  // namespace palpate::geometry
