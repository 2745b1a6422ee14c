#include "scenes/meshes/level_set.h"

#include <numbers>

#include "modules/geometry/mesh_check.h"
#include "tests/modules/geometry/scratch.h"

using namespace palpate;
using namespace palpate::geometry;

TEST_CASE("level set: a ball is closed, outward and of the right volume, at second order") {
  // Oracle: analytic: 4/3 π r³; clamped cuts keep the nodes within 5 % of a cell of the sphere.
  const auto ball = [](const Vec3& p) { return (p - Vec3(0.1, 0, 0)).norm() - 1; };
  const Eigen::AlignedBox3d box(Vec3(-1.3, -1.3, -1.3), Vec3(1.4, 1.3, 1.3));
  const MeshReport report = check_surface(meshes::level_set_surface(ball, box, 0.1));
  CHECK(report.is_closed_manifold());
  CHECK(report.component_count == 1);
  CHECK(report.genus == 0);
  CHECK(report.volume == Approx(4.0 / 3 * std::numbers::pi).epsilon(0.01));
}

TEST_CASE("level set: a ring keeps its hole") {
  // Oracle: topology and Pappus: 2π²Rr².
  const auto ring = [](const Vec3& p) {
    return std::hypot(std::hypot(p.x(), p.y()) - 1, p.z()) - 0.4;
  };
  const Eigen::AlignedBox3d box(Vec3(-1.6, -1.6, -0.6), Vec3(1.6, 1.6, 0.6));
  const MeshReport report = check_surface(meshes::level_set_surface(ring, box, 0.08));
  CHECK(report.genus == 1);
  CHECK(report.is_closed_manifold());
  CHECK(report.volume == Approx(2 * std::pow(std::numbers::pi, 2) * 0.16).epsilon(0.02));
}

TEST_CASE("level set: a shape that leaves the box is open there") {
  // Oracle: hand-made.
  const auto ball = [](const Vec3& p) { return p.norm() - 1; };
  const Eigen::AlignedBox3d box(Vec3(-1.2, -1.2, -1.2), Vec3(0.1, 1.2, 1.2));
  CHECK_FALSE(check_surface(meshes::level_set_surface(ball, box, 0.2)).border_edges.empty());
}
