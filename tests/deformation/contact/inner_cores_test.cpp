#include "deformation/contact/inner_cores.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "modules/geometry/closest_points.h"
#include "modules/geometry/primitives.h"
#include "modules/geometry/winding_number.h"

namespace palpate::deformation {
namespace {

/// Distance of p from the outside of a tool, negative beyond it [m].
double depth_in(const scene::BoxShape& box, const Vec3& p) {
  return (box.size / 2 - p.cwiseAbs()).minCoeff();
}
double depth_in(const scene::ConeShape& cone, const Vec3& p) {
  const double slant = std::hypot(cone.radius, cone.length);
  const double flank = (p.z() * cone.radius - std::hypot(p.x(), p.y()) * cone.length) / slant;
  return std::min(flank, cone.length - p.z());
}

template <class Shape>
void check_within(const Shape& shape, std::size_t count) {
  const auto cores = inner_cores(shape);
  CHECK(cores.size() == count);
  for (const auto& core : cores) {
    CHECK(core.radius > 0);
    for (const double at : {0.0, 0.25, 0.5, 1.0}) {
      CHECK(depth_in(shape, core.a + at * (core.b - core.a)) > core.radius * (1 - 1e-9));
    }
  }
}

/// Of graspers and meshes: some, none nearer to the surface than its radius.
void check_within_surface(const scene::ProbeShape& shape, const geometry::TriangleSurface& mesh,
                          const geometry::TriangleSurface& surface) {
  const auto cores = inner_cores(shape, mesh);
  CHECK_FALSE(cores.empty());
  for (const auto& core : cores) {
    for (int i = 0; i <= 20; ++i) {
      const Vec3 p = core.a + i / 20.0 * (core.b - core.a);
      CHECK(geometry::winding_number(p, surface.nodes, surface.triangles) > 0.5);
      for (const auto& [a, b, c] : surface.triangles) {
        const auto at = geometry::closest_on_triangle(
            p, {surface.nodes[a], surface.nodes[b], surface.nodes[c]});
        REQUIRE((at.point - p).norm() > core.radius * (1 - 1e-9));
      }
    }
  }
}

}  // namespace

TEST_CASE("inner cores: all of them are within their tool, whatever its size") {
  // Oracle: geometry: the distance of their ends and places between them from the tool's outside.
  for (const double size : {1e-4, 2e-3, 0.02, 0.3}) {
    check_within(scene::ConeShape{size / 10, size}, 1);
    check_within(scene::ConeShape{size, size / 2}, 1);
    check_within(scene::BoxShape{Vec3(size, size, size)}, 24);
    check_within(scene::BoxShape{Vec3(size, size / 20, 3 * size)}, 24);
  }
  for (const double opening : {0.02, 0.5, 1.5}) {
    const scene::GrasperShape jaws{.opening = opening};
    check_within_surface(jaws, {}, std::get<geometry::TriangleSurface>(scene::form_of(jaws)));
  }
  const auto ball = geometry::make_ball(0.02, 2);
  check_within_surface(scene::MeshShape{}, ball, ball);
  CHECK(inner_cores(scene::MeshShape{}).empty());
  CHECK(inner_cores(scene::SphereShape{}).empty());
  CHECK(inner_cores(scene::PlaneShape{}).empty());
}

}  // namespace palpate::deformation
