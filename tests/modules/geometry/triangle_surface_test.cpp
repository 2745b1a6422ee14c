#include "modules/geometry/triangle_surface.h"

#include <numbers>
#include <random>

#include "modules/geometry/primitives.h"
#include "tests/modules/geometry/scratch.h"

using namespace palpate;
using namespace palpate::geometry;
using namespace palpate::geometry::test;

namespace {

/// A closed surface without symmetry.
TriangleSurface crumpled_ball() {
  TriangleSurface surface = make_ball(0.05, 2);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> offset(-0.004, 0.004);
  for (Vec3& node : surface.nodes) node += Vec3(offset(random), offset(random), offset(random));
  return surface;
}

}  // namespace

TEST_CASE("enclosed volume: exact for a tetrahedron and a box") {
  // Oracle: analytic, a³/(6√2) and the product of the sides; 1e-14 = a few roundings.
  CHECK(volume_of(make_tetrahedron(0.3)) ==
        Approx(0.027 / (6 * std::numbers::sqrt2)).epsilon(1e-14));
  CHECK(volume_of(make_box({0.1, 0.2, 0.3}, 4)) == Approx(0.006).epsilon(1e-14));
}

TEST_CASE("enclosed volume: of subdivided balls converges to 4/3 π r³ at second order") {
  // Oracle: analytic; halving the edges of an inscribed surface quarters its error.
  const double exact = 4.0 / 3 * std::numbers::pi;
  const double coarse = exact - volume_of(make_ball(1, 3)),
               fine = exact - volume_of(make_ball(1, 4));
  CHECK(coarse > 0);
  CHECK(coarse / fine == Approx(4).epsilon(0.02));
  CHECK(fine / exact < 0.0025);
}

TEST_CASE("enclosed volume: negative inside out, zero without triangles") {
  // Oracle: invariant, orientation reversal changes the sign.
  const TriangleSurface surface = crumpled_ball();
  CHECK(volume_of(inside_out(surface)) == Approx(-volume_of(surface)).epsilon(1e-13));
  CHECK(volume_of({}) == 0);
}

TEST_CASE("enclosed volume: keeps its digits one kilometre away") {
  // Oracle: invariance under translation. Coordinates round at 1e3·2⁻⁵³ ≈ 1e-13 m; over a ball of
  // 0.05 m that is 2e-12 relative, times a few.
  const TriangleSurface surface = crumpled_ball(), far = moved(surface, {1000, -1000, 1000});
  CHECK(volume_of(far) == Approx(volume_of(surface)).epsilon(2e-11));
  const auto [x, y, z] = three_axis_volumes(far.nodes, far.triangles);
  CHECK(x == Approx(y).epsilon(2e-11));
  CHECK(x == Approx(z).epsilon(2e-11));
  CHECK((solid_centroid(far) - solid_centroid(surface) - Vec3(1000, -1000, 1000)).norm() < 1e-11);
}

TEST_CASE("surface area: exact for a box, close below 4πr² for a ball") {
  // Oracle: analytic.
  const TriangleSurface box = make_box({1, 2, 3}, 3), ball = make_ball(1, 4);
  CHECK(surface_area(box.nodes, box.triangles) == Approx(22).epsilon(1e-14));
  const double area = surface_area(ball.nodes, ball.triangles);
  CHECK(area < 4 * std::numbers::pi);
  CHECK(area == Approx(4 * std::numbers::pi).epsilon(0.0025));
}

TEST_CASE("mean edge length: each edge counts once") {
  // Oracle: a unit cube of twelve triangles has twelve edges and six diagonals.
  const TriangleSurface cube = make_box(Vec3(1, 1, 1));
  REQUIRE(cube.triangles.size() == 12);
  CHECK(mean_edge_length(cube) == Approx((12 + 6 * std::sqrt(2.0)) / 18));
}

TEST_CASE("area vector: half the cross product, along the outward normal") {
  // Oracle: analytic, a right triangle with legs 2 and 3 in the x–y plane.
  const std::vector<Vec3> nodes{{1, 1, 5}, {3, 1, 5}, {1, 4, 5}};
  CHECK(area_vector(nodes, {0, 1, 2}) == Vec3(0, 0, 3));
}

TEST_CASE("leak test: the three volumes agree if closed, and disagree with one triangle missing") {
  // Oracle: the divergence theorem.
  TriangleSurface surface = crumpled_ball();
  const auto closed = three_axis_volumes(surface.nodes, surface.triangles);
  for (const double volume : closed) CHECK(volume == Approx(volume_of(surface)).epsilon(1e-12));
  surface.triangles.pop_back();
  const auto open = three_axis_volumes(surface.nodes, surface.triangles);
  const auto [low, high] = std::minmax_element(open.begin(), open.end());
  CHECK(*high - *low > 1e-3 * volume_of(surface));
}

TEST_CASE("solid centroid: of a shifted tetrahedron and of two boxes on each other") {
  // Oracle: analytic: mean of the corners; volume-weighted mean of the boxes' centres.
  CHECK((solid_centroid(moved(make_tetrahedron(1), {1, 2, 3})) - Vec3(1, 2, 3)).norm() < 1e-14);
  const TriangleSurface boxes = both(make_box({2, 2, 2}), moved(make_box({1, 1, 1}, 2), {0, 0, 4}));
  CHECK((solid_centroid(boxes) - Vec3(0, 0, 4.0 / 9)).norm() < 1e-14);
}

TEST_CASE("dominant axis: the long side of a box, turned and with its sign fixed") {
  // Oracle: analytic, the box's symmetry axes.
  TriangleSurface box = make_box({0.1, 0.5, 0.2}, 3);
  CHECK((dominant_axis(box.nodes) - Vec3::UnitY()).norm() < 1e-12);
  const Eigen::AngleAxisd turn(2.5, Vec3(1, 2, -1).normalized());
  for (Vec3& node : box.nodes) node = turn * node + Vec3(7, 8, 9);
  const Vec3 axis = dominant_axis(box.nodes), expected = turn * Vec3::UnitY();
  CHECK(std::abs(axis.dot(expected)) == Approx(1).epsilon(1e-12));
  CHECK(axis.maxCoeff() == axis.cwiseAbs().maxCoeff());
}

TEST_CASE("edges: each once, ascending, 3F/2 of a closed surface") {
  // Oracle: Euler's formula and a hand-counted tetrahedron.
  using Edge = std::array<std::uint32_t, 2>;
  CHECK(edges_of(make_tetrahedron(1).triangles) ==
        std::vector<Edge>{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}});
  const TriangleSurface ball = make_ball(1, 2);
  const auto edges = edges_of(ball.triangles);
  CHECK(edges.size() == ball.triangles.size() * 3 / 2);
  CHECK(std::is_sorted(edges.begin(), edges.end()));
}
