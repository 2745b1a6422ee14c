#include "modules/geometry/probe_form.h"

#include <catch2/catch.hpp>
#include <numbers>

#include "modules/geometry/primitives.h"

namespace palpate::geometry {
namespace {

double volume(const TriangleSurface& surface) {
  return enclosed_volume(surface.nodes, surface.triangles);
}

/// One of each that ends.
std::vector<ProbeForm> bounded_forms() {
  return {RoundedSegment{Vec3(0.001, 0.002, 0), Vec3(0.001, 0.002, 0), 0.01},
          RoundedSegment{Vec3(0.01, -0.03, 0.02), Vec3(-0.02, 0.01, 0.05), 0.01},
          Box{Vec3(0.02, 0.04, 0.06)}, make_tetrahedron(0.02)};
}

}  // namespace

TEST_CASE("probe form: each has its true size", "[analytic]") {
  // Oracle: volumes of the solids; a polyhedron inscribed in a ball or capsule has a little less:
  // 2 % at these subdivisions.
  const double pi = std::numbers::pi, ball = 4 / 3.0 * pi * 1e-6;
  const auto forms = bounded_forms();
  CHECK(volume(surface_of(forms[0], 1)) == Approx(ball).epsilon(0.02));
  const double length = Vec3(0.03, 0.04, 0.03).norm();
  CHECK(volume(surface_of(forms[1], 1)) == Approx(pi * 1e-4 * length + ball).epsilon(0.02));
  CHECK(volume(surface_of(forms[2], 1)) == Approx(0.02 * 0.04 * 0.06));
  const auto mesh = make_tetrahedron(0.02);
  CHECK(surface_of(mesh, 1).nodes == mesh.nodes);
  CHECK(surface_of(mesh, 1).triangles == mesh.triangles);
}

TEST_CASE("probe form: a half-space is drawn as a patch in z = 0 whose front looks up",
          "[analytic]") {
  // Oracle: the half-space z <= 0 is solid, so its outward normal is +z.
  const auto patch = surface_of(HalfSpace{}, 0.3);
  CHECK(surface_area(patch.nodes, patch.triangles) == Approx(0.09));
  for (const auto& triangle : patch.triangles) CHECK(area_vector(patch.nodes, triangle).z() > 0);
}

TEST_CASE("probe form: what it touches with is as large as its smallest rounding") {
  // Oracle: definition.
  const auto forms = bounded_forms();
  CHECK(tip_radius(forms[0]) == 0.01);
  CHECK(tip_radius(forms[1]) == 0.01);
  CHECK(tip_radius(forms[2]) == 0.01);
  CHECK(tip_radius(forms[3]) == 0);
  CHECK(tip_radius(HalfSpace{}) == 0);
}

}  // namespace palpate::geometry
