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
