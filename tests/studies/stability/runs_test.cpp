#include "studies/stability/runs.h"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>
#include <iostream>

#include "studies/stability/maps.h"
#include "tests/studies/keep_on.h"

namespace palpate::stability {
namespace {

using report::kKeepOn;

/// The map with values of one's own.
Map map_named(const std::string& name, std::vector<double> ys) {
  for (Map& map : maps(true)) {
    if (map.name != name) continue;
    map.ys = std::move(ys);
    map.precision = 0.02;
    return map;
  }
  FAIL("no map " << name);
  return {};
}

void check_against_theory(const std::string& name, const std::string& series, double x) {
  const Map map = map_named(name, geometric(1e-4, 0.03, 5));
  const Column column = measure_column(map, series, x, kKeepOn);
  const Frontier frontier = frontier_of(column.cells);
  std::cout << name << ", " << series << ", x = " << x << ": measured " << frontier.value
            << " s, predicted " << column.prediction.value << " s\n";
  REQUIRE(column.prediction.exact);
  REQUIRE(frontier.edge == Edge::kFound);
  CHECK(frontier.value / column.prediction.value == Approx(1).margin(0.1));
}

TEST_CASE("runs: a swinging ball ends to be stable where the springs' frequencies say") {
  // Oracle: analytic, 2/ω_max. 10 %: the goal of the atlas; 2 % of it is the bisection's.
  for (const char* series : {"mass_spring", "implicit_volume", "penalty", "bourguignon_cani"}) {
    check_against_theory("step_stiffness", series, 2e4);
  }
}

TEST_CASE("runs: a sliver shortens the stable step as its frequencies say") {
  // Oracle: analytic, 2/ω_max, by the same margin.
  check_against_theory("mesh_quality", "implicit_volume", 4);
  check_against_theory("mesh_quality", "implicit_volume", 100);
}

TEST_CASE("runs: implicit steps stand at any size, explicit ones do not, and say how") {
  // Oracle: backward Euler damps every mode, xpbd has no stiffness too much.
  Shapes shapes;
  for (const char* name : {"implicit_volume_backward", "xpbd_springs", "corotational"}) {
    const Scheme& scheme = scheme_named(name);
    INFO(name);
    CHECK(holds(swing(scheme, shapes.shape_for(scheme), 1e6, 0.05, kKeepOn).state));
  }
  const Scheme& scheme = scheme_named("implicit_volume");
  const Verdict verdict = swing(scheme, shapes.shape_for(scheme), 1e6, 0.05, kKeepOn);
  CHECK(verdict.state == State::kDiverged);
  CHECK_FALSE(verdict.energy < kDivergedGain);
}

TEST_CASE("runs: modal motion and ChainMail stand at any step, being exact or no motion at all") {
  // Oracle: an oscillator's exact solution keeps its energy; a Jacobi step of r = ½ only loses it.
  Shapes shapes;
  for (const char* name : {"modal", "chainmail"}) {
    const Scheme& scheme = scheme_named(name);
    INFO(name);
    for (const double h : {1e-4, 1e-2, 0.1}) {
      const Verdict verdict = swing(scheme, shapes.shape_for(scheme), 1e5, h, kKeepOn);
      CHECK(verdict.state == State::kStable);
      CHECK(verdict.energy < 1.5);
    }
  }
}

TEST_CASE("runs: triangles are inverted where they face inwards, however the ball is turned") {
  // Oracle: none of a turned ball; some around a node drawn sideways over its neighbours. The best
  // rotation of an everted ball is half a turn about any axis a: those normals with (a·n)² < ½.
  Shapes shapes;
  const Scheme& scheme = scheme_named("implicit_volume");
  const TestBody body(organ_of(scheme, 1e4), shapes.shape_for(scheme));
  const auto& model = body.model();
  auto x = body.state().positions;
  const Eigen::AngleAxisd turn(3, Vec3(1, 2, -1).normalized());
  for (Vec3& p : x) p = turn * p;
  CHECK(inverted_share(model, x) == 0);
  auto folded = x;
  folded[0] += kBallRadius * x[0].unitOrthogonal();
  const double around = inverted_share(model, folded) * double(model.triangles.size());
  CHECK(around >= 1);
  CHECK(around <= 6);
  for (Vec3& p : x) p = -p;
  CHECK(inverted_share(model, x) == Approx(std::sqrt(0.5)).margin(0.02));
}

TEST_CASE("runs: a squeezed ball touches the plates, keeps its volume, and stands at small steps") {
  // Oracle: nodes do not pass the plates; the volume constraint; plain springs lose more than 1 %.
  Shapes shapes;
  std::unique_ptr<TestBody> end;
  const Scheme& kept = scheme_named("implicit_volume");
  const Verdict verdict = squeeze(kept, shapes.shape_for(kept), 0.3, 2e-3, kKeepOn, &end);
  CHECK(verdict.state == State::kStable);
  CHECK(verdict.volume_error < 1e-6);
  double highest = 0;
  for (const Vec3& p : end->state().positions) highest = std::max(highest, std::abs(p.z()));
  CHECK(highest == Approx(0.7 * kBallRadius).epsilon(1e-3));
  const Scheme& springs = scheme_named("mass_spring");
  CHECK(squeeze(springs, shapes.shape_for(springs), 0.3, 2e-3, kKeepOn).volume_error > 0.01);
}

TEST_CASE("runs: a sphere driven in and out dents the ball by its depth and leaves it whole") {
  // Oracle: the top node is under the sphere at 20 mm depth, 0.4 R; afterwards it stands.
  Shapes shapes;
  const Scheme& scheme = scheme_named("implicit_volume");
  const Verdict verdict = poke(scheme, shapes.shape_for(scheme), 0.3, 2e-3, kKeepOn);
  CHECK(verdict.state == State::kStable);
  CHECK(verdict.displacement == Approx(0.4).margin(0.05));
  CHECK(verdict.inverted == 0);
}

TEST_CASE("runs: whoever wants it to end ends it") {
  // Oracle: what keep_going throws comes out.
  struct Stop {};
  Shapes shapes;
  const Scheme& scheme = scheme_named("mass_spring");
  const auto& shape = shapes.shape_for(scheme);
  CHECK_THROWS_AS(swing(scheme, shape, 1e4, 1e-3, [] { throw Stop{}; }), Stop);
  CHECK_THROWS_AS(squeeze(scheme, shape, 0.1, 1e-3, [] { throw Stop{}; }), Stop);
  CHECK_THROWS_AS(poke(scheme, shape, 0.1, 1e-3, [] { throw Stop{}; }), Stop);
}

}  // namespace
}  // namespace palpate::stability
