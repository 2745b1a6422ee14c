#include "studies/stability/haptic_loop.h"

#include <catch2/catch.hpp>
#include <iostream>

#include "studies/stability/atlas.h"
#include "tests/studies/keep_on.h"

namespace palpate::stability {
namespace {

using report::kKeepOn;

Frontier frontier(const Loop& loop, double delay) {
  Map map{"loop", {"one"}, {delay}, geometric(1, 1e3, 4), 0.02, {}, {}};
  map.attempt = [&](const std::string&, double x, double y, const KeepGoing& keep_going) {
    return close_loop(loop, x, y, keep_going);
  };
  map.predict = [](const std::string&, double) { return Prediction{}; };
  return frontier_of(measure_column(map, "one", delay, kKeepOn).cells);
}

TEST_CASE(
    "haptic loop: the frontier lies where the formula says, at two rates, late and as soon as can "
    "be") {
  // Oracle: analytic, K = b/(T/2 + t_d), exact for slow motions. 10 %: the goal of the atlas.
  struct Case {
    Loop loop;
    double delay;
  };
  for (const Case& c : {Case{{1000, false, false}, 0.001}, Case{{1000, false, false}, 0.01},
                        Case{{500, false, false}, 0.02}, Case{{500, true, false}, 0.02}}) {
    const double formula = critical_stiffness(c.loop, c.delay);
    const Frontier found = frontier(c.loop, c.delay);
    std::cout << "haptic loop, " << c.loop.rate << " Hz, " << (c.loop.local_model ? "law" : "force")
              << ", delay " << c.delay << " s: formula " << formula << " N/m, found " << found.value
              << " N/m\n";
    CHECK(found.edge == Edge::kFound);
    CHECK(found.value / formula == Approx(1).margin(0.1));
  }
}

TEST_CASE("haptic loop: beyond the frontier the bare law leaves, the whole chain stays bounded") {
  // Oracle: invariant, the passivity controller and the force limits bound what the law does not.
  const double stiffness = 3 * critical_stiffness({1000, true, false}, 0);
  CHECK(close_loop({1000, true, false}, 0.001, stiffness, kKeepOn).state == State::kDiverged);
  const Verdict passive = close_loop({1000, true, true}, 0.001, stiffness, kKeepOn);
  CHECK(passive.state == State::kOscillating);
  CHECK(passive.displacement < 1);
}

}  // namespace
}  // namespace palpate::stability
