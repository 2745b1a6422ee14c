#include "visualizer/probe_shape.h"

#include <catch2/catch.hpp>
#include <numbers>

#include "modules/geometry/primitives.h"

using namespace palpate;
using namespace palpate::visualizer;

TEST_CASE("probe surface: each shape has its true size", "[visualizer][analytic]") {
  // Oracle: volumes of the solids; a polyhedron inscribed in a ball or capsule has a little less:
  // 2 % at these subdivisions.
  const auto volume = [](const geometry::TriangleSurface& s) {
    return geometry::enclosed_volume(s.nodes, s.triangles);
  };
  const double pi = std::numbers::pi;
  const auto ball = probe_surface(scene::SphereShape{0.01}, 1, {});
  CHECK(volume(ball) == Approx(4 / 3.0 * pi * 1e-6).epsilon(0.02));
  CHECK(reach(ball) == Approx(0.01));
  const auto capsule = probe_surface(scene::CapsuleShape{0.01, 0.05}, 1, {});
  CHECK(volume(capsule) == Approx(pi * 1e-4 * 0.05 + 4 / 3.0 * pi * 1e-6).epsilon(0.02));
  CHECK(reach(capsule) == Approx(0.035));
  const auto box = probe_surface(scene::BoxShape{Vec3(0.02, 0.04, 0.06)}, 1, {});
  CHECK(volume(box) == Approx(0.02 * 0.04 * 0.06));
  CHECK(reach(box) == Approx(Vec3(0.01, 0.02, 0.03).norm()));
}

TEST_CASE("probe surface: a plane is a patch in z = 0 whose front looks up",
          "[visualizer][analytic]") {
  // Oracle: the half-space z <= 0 is solid, so its outward normal is +z.
  const auto patch = probe_surface(scene::PlaneShape{}, 0.3, {});
  CHECK(geometry::surface_area(patch.nodes, patch.triangles) == Approx(0.09));
  for (const auto& triangle : patch.triangles) {
    CHECK(geometry::area_vector(patch.nodes, triangle).z() > 0);
  }
}

TEST_CASE("probe surface: a mesh is itself", "[visualizer]") {
  // Oracle: identity.
  const auto mesh = geometry::make_tetrahedron(0.02);
  const auto shown = probe_surface(scene::MeshShape{}, 1, mesh);
  CHECK(shown.nodes == mesh.nodes);
  CHECK(shown.triangles == mesh.triangles);
}
