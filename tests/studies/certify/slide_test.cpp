#include "studies/certify/slide.h"

#include <catch2/catch.hpp>

#include "tests/studies/certify/subjects.h"

using namespace palpate;
using namespace palpate::testing;
using namespace palpate::certify;

TEST_CASE("certify slide: rows cross the organ at the same depth below its skin, at the speed") {
  // Oracle: analytic, a ball that rolls on a ball keeps R + r; pressed by half the depth along −z
  // it is below by depth/2 · cos of the skin's lean, here to 50°. 0.3 mm: flat triangles.
  const BallScene scene(kFingerFromAbove);
  Subject subject = load_subject(scene.file(), kGoOn);
  const auto path = slide_path(subject, 0), row = slide_path(subject, 1);
  REQUIRE(row.size() > 20);
  CHECK(path.size() > 2 * row.size());
  std::size_t pressing = 0;
  for (std::size_t i = 1; i < path.size(); ++i) {
    const Vec3& at = path[i].pose.position;
    const double time = path[i].time - path[i - 1].time;
    REQUIRE(time > 0);
    CHECK((at - path[i - 1].pose.position).norm() / time < 0.151);
    const Vec3 touched = at - subject.depth / 2 * subject.place.into;
    pressing += std::abs(touched.norm() - kBallRadius - kFingerRadius) < 3e-4;
  }
  CHECK(pressing > path.size() - 30);
}

TEST_CASE("certify slide: a step counts against 5 % of the force or 0.05 N") {
  // Oracle: definition.
  CHECK(slide_line({}).verdict == Verdict::kNotMeasured);
  const auto tick = [](double force, double step) {
    return SlideTick{0, Vec3::Zero(), force, step};
  };
  CHECK(slide_line({tick(0, 0.04), tick(2, 0.09)}).verdict == Verdict::kPass);
  const Line line = slide_line({tick(2, 0.09), tick(0.5, 0.06), tick(0, 0)});
  CHECK(line.verdict == Verdict::kFail);
  CHECK(line.value == 0.06);
  CHECK(line.limit == 0.05);
}

TEST_CASE("certify slide: the force is that of the organ along the path") {
  // Oracle: invariant, there is force on a row and none when it has left.
  const BallScene scene(kFingerFromAbove);
  const Subject subject = load_subject(scene.file(), kGoOn);
  const auto ticks = slide(loop_on_organ(subject), slide_path(subject, 1), kGoOn);
  CHECK(ticks.front().force == 0);
  CHECK(ticks[ticks.size() / 2].force > 0.005);
  CHECK(ticks.back().force == 0);
}
