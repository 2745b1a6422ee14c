#include "modules/scene/probe_shape.h"

#include <catch2/catch.hpp>

#include "modules/geometry/primitives.h"

namespace palpate::scene {

TEST_CASE("probe shape: each comes down to the form that its keys describe") {
  // Oracle: the meaning of the keys.
  const auto sphere = std::get<geometry::RoundedSegment>(form_of(SphereShape{0.01}));
  CHECK(sphere.is_ball());
  CHECK(sphere.a == Vec3::Zero());
  CHECK(sphere.radius == 0.01);
  const auto capsule = std::get<geometry::RoundedSegment>(form_of(CapsuleShape{0.01, 0.05}));
  CHECK(capsule.a == Vec3(0, 0, -0.025));
  CHECK(capsule.b == Vec3(0, 0, 0.025));
  CHECK(std::get<geometry::Box>(form_of(BoxShape{Vec3(1, 2, 3)})).size == Vec3(1, 2, 3));
  CHECK(std::holds_alternative<geometry::HalfSpace>(form_of(PlaneShape{})));
  const auto cone = std::get<geometry::TriangleSurface>(form_of(ConeShape{0.003, 0.02}));
  CHECK(cone.nodes == geometry::make_cone(0.003, 0.02).nodes);
  const auto jaws =
      std::get<geometry::TriangleSurface>(form_of(GrasperShape{0.02, 0.005, 0.003, 0.4}));
  CHECK(jaws.nodes == geometry::make_jaws(0.02, 0.005, 0.003, 0.4).nodes);
  const auto mesh = geometry::make_tetrahedron(0.02);
  CHECK(std::get<geometry::TriangleSurface>(form_of(MeshShape{}, mesh)).nodes == mesh.nodes);
}

TEST_CASE("probe shape: only a mesh names a file") {
  // Oracle: definition.
  ProbeShape shape = MeshShape{{"probe.ply"}};
  REQUIRE(mesh_of(shape) != nullptr);
  CHECK(mesh_of(shape)->file == "probe.ply");
  shape = BoxShape{};
  CHECK(mesh_of(shape) == nullptr);
}

}  // namespace palpate::scene
