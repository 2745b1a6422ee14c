#include "deformation/contact/touch_follower.h"

#include <catch2/catch.hpp>

#include "tests/deformation/steppers/tetrahedral_solids.h"

namespace palpate::deformation {
namespace {

OrganModel flat_solid(int cells) {
  return build_organ_model(
      testing::solid_organ("nodal_pressure", 0.499), Vec3::Zero(),
      geometry::shape_of(geometry::testing::block(Vec3(0.1, 0.1, 0.05), cells, cells, cells)));
}

std::vector<TouchedPlace> places_under(TouchFollower& touch, const OrganModel& model,
                                       const Vec3& at) {
  std::vector<TouchedPlace> places;
  touch.look({at, Quat::Identity()}, model, model.rest_positions, places);
  return places;
}

geometry::RoundedSegment ball_of(double radius) { return {Vec3::Zero(), Vec3::Zero(), radius}; }

TEST_CASE("touch follower: a ball near the skin is below itself, one further than 2 R nowhere") {
  // Oracle: geometry; the grid of R/16 and the coarse triangles' middles are allowed for.
  const OrganModel model = flat_solid(10);
  constexpr double kR = 8e-3;
  TouchFollower touch(ball_of(kR), {}, 0.5);
  CHECK(places_under(touch, model, {0.05, 0.05, 0.05 + kR + 2.1 * kR}).empty());
  const auto places = places_under(touch, model, {0.052, 0.047, 0.05 + kR + 1.5 * kR});
  REQUIRE(places.size() == 1);
  CHECK((places[0].centre - Vec3(0.052, 0.047, 0.05)).norm() < kR / 3);
  CHECK(places[0].edge == Approx(kR / 2));
  CHECK(places[0].plateau > kR);
  // It stays a little further away than it came, then it is gone.
  CHECK(places_under(touch, model, {0.052, 0.047, 0.05 + kR + 2.3 * kR}).size() == 1);
  CHECK(places_under(touch, model, {0.052, 0.047, 0.05 + kR + 2.6 * kR}).empty());
}

TEST_CASE("touch follower: a place stays until the touch is R/4 away, then the plateau holds it") {
  // Oracle: the stated rule, on a slide of 40 mm: no more places than R/4 makes, and the touch
  // never further than plateau − R from its place.
  const OrganModel model = flat_solid(20);
  constexpr double kR = 8e-3;
  TouchFollower touch(ball_of(kR), {}, 0.5);
  int changes = 0;
  Vec3 last = Vec3::Zero();
  for (int k = 0; k <= 400; ++k) {
    const Vec3 at(0.03 + 1e-4 * k, 0.05, 0.05 + kR);
    const auto places = places_under(touch, model, at);
    REQUIRE(places.size() == 1);
    changes += (places[0].centre - last).norm() > 0;
    last = places[0].centre;
    const Vec3 below(at.x(), at.y(), 0.05);
    CHECK((last - below).norm() < places[0].plateau - kR + kR / 5);
  }
  CHECK(changes > 10);
  CHECK(changes < 30);
}

TEST_CASE("touch follower: a capsule that lies flat is followed all along, a plane is not") {
  // Oracle: the capsule's ends; a half-space has no size.
  const OrganModel model = flat_solid(10);
  TouchFollower lying(geometry::RoundedSegment{{-0.02, 0, 0}, {0.02, 0, 0}, 5e-3}, {}, 0.5);
  const auto places = places_under(lying, model, {0.05, 0.05, 0.0551});
  REQUIRE(places.size() >= 8);
  CHECK((places.front().centre - Vec3(0.03, 0.05, 0.05)).norm() < 3e-3);
  CHECK((places.back().centre - Vec3(0.07, 0.05, 0.05)).norm() < 3e-3);
  TouchFollower plane(geometry::HalfSpace{}, {}, 0.5);
  CHECK(places_under(plane, model, {0.05, 0.05, 0.05}).empty());
}

TEST_CASE("touch follower: a box is followed at the corners that are near") {
  // Oracle: geometry: four of eight touch.
  const OrganModel model = flat_solid(10);
  TouchFollower box(geometry::Box{Vec3(0.02, 0.02, 0.04)}, {}, 0.5);
  CHECK(places_under(box, model, {0.05, 0.05, 0.07}).size() == 4);
  CHECK(box.radius() == Approx(0.01));
}

TEST_CASE("touch follower: edges by the error of force that is allowed") {
  // Oracle: docs/accuracy.md, medians of its table: 27 % at R, 9 % at R/2, 4.5 % at R/3.
  CHECK(edge_over_radius(0.27) == Approx(1));
  CHECK(edge_over_radius(0.09) == Approx(0.5).epsilon(0.05));
  CHECK(edge_over_radius(0.045) == Approx(1.0 / 3).epsilon(0.05));
  CHECK(edge_over_radius(1) == 1);
  CHECK(edge_over_radius(1e-3) == 0.25);
  // Quadratic ones, the same table: 2.7 % at R; 1 % at 0.7 R, the least that was measured.
  CHECK(quadratic_edge_over_radius(0.1) == 1);
  CHECK(quadratic_edge_over_radius(0.0105) == Approx(0.7).epsilon(0.05));
  CHECK(quadratic_edge_over_radius(1e-3) == 0.7);
}

}  // namespace
}  // namespace palpate::deformation
