#include "studies/certify/loop.h"

#include <catch2/catch.hpp>

#include "studies/certify/hands.h"
#include "tests/studies/certify/subjects.h"

using namespace palpate;
using namespace palpate::testing;
using namespace palpate::certify;

TEST_CASE("certify loop: a firm hand rests on a wall where both springs say") {
  // Oracle: analytic, K x = k (x_t − x) with the hand's k = 500 N/m; work of the motors −K x²/2
  // and what contact damping takes.
  // The swing that is left after 3 s and encoder steps of 55 µm leave 1 %; the law's tick gives or
  // takes K v x T, below 2 % of the work at 40 mm/s.
  const Subject subject = wall_subject();
  const Loop wall = loop_on_wall(subject.scene, 100);
  const auto hand =
      firm_hand(subject.device, wall.place, {{pose_below(wall.place, 6e-3).position, 0.3}});
  const auto ticks = run_loop(wall, hand, 3, kGoOn);
  REQUIRE(ticks.size() == 3000);
  const double depth = 500 * 6e-3 / 600;
  CHECK(ticks.back().depth == Approx(depth).epsilon(0.01));
  CHECK(ticks.back().motor == Approx(100 * depth).epsilon(0.02));
  CHECK(ticks.back().work + taken_by_damping(ticks, 1e-3) ==
        Approx(-50 * depth * depth).epsilon(0.04));
  CHECK(ticks.front().depth == Approx(-kAbove));
  CHECK(first_force(ticks)->depth == Approx(0).margin(2e-4));
  CHECK(swing(ticks, 0, 3) == Approx(kAbove + depth).epsilon(0.1));
  CHECK(std::isinf(swing(ticks, 0, 4)));
  CHECK(largest_step(ticks, 0, 0.02).step == 0);
}

TEST_CASE("certify loop: the same bits each time, and it ends when the device has left") {
  // Oracle: bit for bit; free fall under a push, x = 0.2 m.
  const Subject subject = wall_subject();
  const Loop wall = loop_on_wall(subject.scene, 0.01);
  const auto hand = pushing_hand(subject.device, wall.place, 10);
  const auto once = run_loop(wall, hand, 5, kGoOn), again = run_loop(wall, hand, 5, kGoOn);
  CHECK(once.back().off.norm() > 0.2);
  CHECK(once.back().time < 0.5);
  REQUIRE(once.size() == again.size());
  CHECK(once.back().off == again.back().off);
}
