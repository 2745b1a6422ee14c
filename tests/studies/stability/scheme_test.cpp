#include "studies/stability/scheme.h"

#include <catch2/catch.hpp>
#include <set>

#include "modules/geometry/primitives.h"

namespace palpate::stability {
namespace {

TEST_CASE("schemes: each has a name of its own, and steps") {
  // Oracle: the list's meaning; one small step leaves a ball at rest at rest, to float's digits.
  Shapes shapes;
  std::set<std::string> names;
  for (const Scheme& scheme : schemes()) {
    INFO(scheme.name);
    CHECK(names.insert(scheme.name).second);
    CHECK(&scheme_named(scheme.name) == &scheme);
    TestBody body(organ_of(scheme, kYoungsModulus), shapes.shape_for(scheme));
    body.dynamics().step(1e-4, {}, body.state());
    double fastest = 0;
    for (const Vec3& v : body.state().velocities) fastest = std::max(fastest, v.norm());
    CHECK(fastest < 1e-4);
    CHECK(body.mass() == Approx(1058 * body.model().rest_volume));
  }
}

TEST_CASE("schemes: the ball with a sliver is closed, and its sliver has the height asked for") {
  // Oracle: enclosed volume of the ball, which the sliver's nodes lie in the surface of; height by
  // area over edge.
  const double plain = [] {
    const auto ball = geometry::make_ball(kBallRadius, 2);
    return geometry::enclosed_volume(ball.nodes, ball.triangles);
  }();
  for (const double ratio : {4.0, 100.0, 1000.0}) {
    const auto shape = ball_with_sliver(ratio);
    const auto& x = shape.surface.nodes;
    CHECK(geometry::enclosed_volume(x, shape.surface.triangles) == Approx(plain).epsilon(1e-12));
    CHECK(x.size() == 164);
    CHECK(shape.surface.triangles.size() == 324);
    CHECK(geometry::edges_of(shape.surface.triangles).size() == 164 + 324 - 2);  // Euler
    const auto& sliver = shape.surface.triangles[322];                           // b, apex, core
    const Vec3 a = x[shape.surface.triangles[321][0]], b = x[sliver[0]], apex = x[sliver[1]];
    const double height = (b - a).cross(apex - a).norm() / (b - a).norm();
    CHECK((b - a).norm() / height == Approx(ratio).epsilon(1e-9));
  }
}

TEST_CASE("schemes: theory is given for explicit springs, and not for implicit or solid models") {
  // Oracle: where 2/ω_max applies.
  Shapes shapes;
  for (const char* name : {"mass_spring", "implicit_volume", "penalty"}) {
    const Scheme& scheme = scheme_named(name);
    TestBody body(organ_of(scheme, kYoungsModulus), shapes.shape_for(scheme));
    const Prediction prediction = predict(scheme, body);
    CHECK(prediction.exact);
    CHECK(prediction.value > prediction.given);
  }
  for (const char* name : {"implicit_volume_backward", "xpbd_springs", "zordan", "corotational",
                           "quadratic_elements", "modal", "chainmail"}) {
    const Scheme& scheme = scheme_named(name);
    TestBody body(organ_of(scheme, kYoungsModulus), shapes.shape_for(scheme));
    const Prediction prediction = predict(scheme, body);
    CHECK_FALSE(prediction.exact);
    CHECK(std::isnan(prediction.value));
    CHECK(prediction.given > 0);
  }
}

}  // namespace
}  // namespace palpate::stability
