#include "deformation/contact/outer_seat.h"

#include <catch2/catch.hpp>

#include "modules/geometry/winding_number.h"
#include "tests/collision/random_shapes.h"
#include "tests/deformation/organs.h"

namespace palpate::deformation {
namespace {

std::vector<CoreLine> ball_at(const Vec3& p) { return {{p, p}}; }

TEST_CASE("outer seat: a wall comes off points inside it, and no further than to them") {
  // Oracle: the winding number over all triangles; of least motion, a place that moves by d for
  // weights w needs |Δx| ≤ d / √Σw² ≤ √3 d of its corners, a few times over where walls fold.
  const OrganModel model = testing::ball_model(3);
  const double radius = model.rest_positions[0].norm();
  collision::RandomShapes random(11);
  for (int trial = 0; trial < 50; ++trial) {
    std::vector<Vec3> x = model.rest_positions;
    const double depth = random.number(1e-4, 0.2 * radius);
    const Vec3 p = (radius - depth) * random.direction();
    CHECK(seat_outside(ball_at(p), model, x));
    CHECK(geometry::winding_number(p, x, model.triangles) < 0.5);
    double farthest = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      farthest = std::max(farthest, (x[i] - model.rest_positions[i]).norm());
    }
    CHECK(farthest < 4 * depth);
  }
}

TEST_CASE("outer seat: a wall comes off a core that it lies across, wherever between its ends") {
  // Oracle: the winding number at 200 places along it. Both ends are outside; what is inside is
  // a chord of any length, down to less than any two places looked at are apart.
  const OrganModel model = testing::ball_model(3);
  const double radius = model.rest_positions[0].norm();
  collision::RandomShapes random(13);
  int chords = 0;
  for (int trial = 0; trial < 30; ++trial) {
    std::vector<Vec3> x = model.rest_positions;
    const Vec3 out = random.direction();
    const Vec3 along = (out.unitOrthogonal() + 0.2 * random.direction()).normalized();
    const Vec3 middle = (radius - random.number(0.005, 0.1) * radius) * out;
    const double back = random.number(0.6, 2) * radius, on = random.number(0.6, 2) * radius;
    const std::vector<CoreLine> core{{middle - back * along, middle + on * along}};
    const auto inside = [&] {
      int count = 0;
      for (int i = 0; i < 200; ++i) {
        const Vec3 p = core[0].a + i / 199.0 * (core[0].b - core[0].a);
        count += geometry::winding_number(p, x, model.triangles) > 0.5;
      }
      return count;
    };
    chords += inside() > 0;
    if (inside() > 0) CHECK_FALSE(are_outside(core, model, x));
    CHECK(seat_outside(core, model, x));
    CHECK(inside() == 0);
    CHECK(are_outside(core, model, x));
  }
  CHECK(chords > 20);
}

TEST_CASE("outer seat: a wall that folds over another comes off, whatever front is nearer") {
  // Oracle: the winding number over all triangles. Two balls that overlap, as one wall: points in
  // the one, nearer to the front of the other.
  OrganModel model = testing::ball_model(3);
  const double radius = model.rest_positions[0].norm();
  const std::vector<Vec3> one = model.rest_positions;
  const auto triangles = model.triangles;
  const auto count = static_cast<std::uint32_t>(one.size());
  for (const auto& [a, b, c] : triangles) {
    model.triangles.push_back({a + count, b + count, c + count});
  }
  model.inverse_masses.resize(2 * one.size(), model.inverse_masses[0]);
  model.surface_node_count = 2 * one.size();
  collision::RandomShapes random(12);
  for (int trial = 0; trial < 50; ++trial) {
    const Vec3 out = random.direction();
    const double depth = random.number(0.02, 0.1) * radius;
    const double gap = random.number(0.05, 0.5) * depth;
    // The second ball's front is `gap` beside the point, which is `depth` below the first's.
    const Vec3 p = (radius - depth) * out, beside = out.unitOrthogonal();
    std::vector<Vec3> x = one;
    for (const Vec3& node : one) x.push_back(node + p + (radius + gap) * beside);
    if (geometry::winding_number(p, x, model.triangles) < 0.5) continue;
    CHECK(seat_outside(ball_at(p), model, x));
    CHECK(geometry::winding_number(p, x, model.triangles) < 0.5);
  }
}

TEST_CASE("outer seat: a wall that points are outside of stays, and what is held does") {
  // Oracle: the same positions.
  OrganModel model = testing::ball_model(2);
  std::vector<Vec3> x = model.rest_positions;
  const double radius = x[0].norm();
  CHECK(seat_outside(ball_at({0, 0, 1.1 * radius}), model, x));
  CHECK(x == model.rest_positions);
  std::ranges::fill(model.inverse_masses, 0.0);
  CHECK_FALSE(seat_outside(ball_at({0, 0, 0.8 * radius}), model, x));
  CHECK(x == model.rest_positions);
}

}  // namespace
}  // namespace palpate::deformation
