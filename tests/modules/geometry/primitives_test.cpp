#include "modules/geometry/primitives.h"

#include <numbers>

#include "modules/geometry/mesh_check.h"
#include "tests/modules/geometry/scratch.h"

using namespace palpate;
using namespace palpate::geometry;

TEST_CASE("ball: 10·4ⁿ + 2 nodes, all at the radius, holds a volume") {
  // Oracle: analytic counts and distances.
  std::size_t expected = 12;
  for (int levels = 0; levels <= 4; ++levels) {
    const TriangleSurface ball = make_ball(0.05, levels);
    CHECK(ball.nodes.size() == expected);
    CHECK(ball.triangles.size() == 2 * expected - 4);
    for (const Vec3& node : ball.nodes) CHECK(node.norm() == Approx(0.05).epsilon(1e-14));
    CHECK(check_surface(ball).holds_volume());
    expected = 4 * (expected - 2) + 2;
  }
}

TEST_CASE("box: corners, counts and closedness for every division") {
  // Oracle: analytic: 6d² + 2 nodes, 12d² triangles, the sizes asked for.
  for (std::size_t divisions = 1; divisions <= 4; ++divisions) {
    const TriangleSurface box = make_box({1, 2, 3}, static_cast<int>(divisions));
    const MeshReport report = check_surface(box);
    CHECK(report.node_count == 6 * divisions * divisions + 2);
    CHECK(report.triangle_count == 12 * divisions * divisions);
    CHECK(report.holds_volume());
    CHECK(report.min_corner == Vec3(-0.5, -1, -1.5));
    CHECK(report.max_corner == Vec3(0.5, 1, 1.5));
  }
}

TEST_CASE("capsule: nodes on its surface, volume near the smooth one, lengths 0 and more") {
  // Oracle: analytic: distance to the axis segment is the radius; πr²l + 4/3 πr³ from below, the
  // inscribed 48-gon being 0.3 % and the caps 0.7 % short.
  for (const double length : {0.0, 0.001, 0.02, 0.3}) {
    const double radius = 0.01;
    const TriangleSurface capsule = make_capsule(radius, length, 48);
    for (const Vec3& node : capsule.nodes) {
      const Vec3 on_axis(0, 0, std::clamp(node.z(), -length / 2, length / 2));
      CHECK((node - on_axis).norm() == Approx(radius).epsilon(1e-12));
    }
    const MeshReport report = check_surface(capsule);
    CHECK(report.holds_volume());
    CHECK(report.genus == 0);
    const double smooth = std::numbers::pi * radius * radius * (length + 4.0 / 3 * radius);
    CHECK(report.volume < smooth);
    CHECK(report.volume == Approx(smooth).epsilon(0.01));
    CHECK(report.max_corner.z() == Approx(length / 2 + radius).epsilon(1e-14));
  }
  CHECK(check_surface(make_capsule(0.01, 0.02, 4)).holds_volume());
}

TEST_CASE("cone: its point at the origin, its flats inside the smooth one, its volume") {
  // Oracle: analytic; a third of base times height, of a regular polygon.
  for (const int sides : {3, 8, 32}) {
    const double radius = 0.003, length = 0.02, angle = 2 * std::numbers::pi / sides;
    const TriangleSurface cone = make_cone(radius, length, sides);
    const MeshReport report = check_surface(cone);
    CHECK(report.holds_volume());
    CHECK(report.genus == 0);
    CHECK(report.volume ==
          Approx(sides * radius * radius * std::sin(angle) / 2 * length / 3).epsilon(1e-12));
    CHECK(cone.nodes[0] == Vec3::Zero());
    CHECK(report.min_corner.z() == 0);
    CHECK(report.max_corner.z() == length);
    const double within = std::hypot(length, radius * std::cos(angle / 2)) / length;
    for (const auto& [a, b, c] : cone.triangles) {
      if (a != 0) continue;  // a flat of the side: its plane is so far from the axis
      const Vec3 n = (cone.nodes[b] - cone.nodes[a]).cross(cone.nodes[c] - cone.nodes[a]);
      CHECK(-n.z() / n.norm() * within == Approx(radius * std::cos(angle / 2) / length));
    }
  }
}

TEST_CASE("jaws: open by the angle asked for, their tips about the origin, their volume") {
  // Oracle: analytic; the outline's area by hand times the width.
  const double length = 0.02, width = 0.005, thickness = 0.003;
  for (const double opening : {0.02, 0.5, 1.5}) {
    const TriangleSurface jaws = make_jaws(length, width, thickness, opening);
    const MeshReport report = check_surface(jaws);
    CHECK(report.holds_volume());
    CHECK(report.genus == 0);
    CHECK(report.self_intersections.empty());
    const double c = std::cos(opening / 2), s = std::sin(opening / 2);
    // Two jaws, each a rectangle and half a square, and the triangle between their hinges.
    const double between = thickness * (c - s) * thickness * (c + s);
    CHECK(report.volume ==
          Approx(width * (2 * length * thickness + thickness * thickness + between)));
    CHECK(report.max_corner.x() == width / 2);
    Vec3 tips = Vec3::Zero();
    for (const std::uint32_t tip : {1u, 4u, 8u, 11u}) tips += jaws.nodes[tip];
    CHECK(tips.norm() < 1e-15);
    CHECK((jaws.nodes[1] - jaws.nodes[4]).norm() == Approx(2 * length * s));
    CHECK((jaws.nodes[1] - jaws.nodes[0]).norm() == Approx(length));
  }
}

TEST_CASE("tetrahedron: regular, about the origin") {
  // Oracle: analytic, six equal edges and a zero mean.
  const TriangleSurface tetrahedron = make_tetrahedron(0.2);
  for (const auto& [a, b] : edges_of(tetrahedron.triangles)) {
    CHECK((tetrahedron.nodes[a] - tetrahedron.nodes[b]).norm() == Approx(0.2).epsilon(1e-14));
  }
  Vec3 sum = Vec3::Zero();
  for (const Vec3& node : tetrahedron.nodes) sum += node;
  CHECK(sum.norm() < 1e-16);
  CHECK(check_surface(tetrahedron).holds_volume());
}
