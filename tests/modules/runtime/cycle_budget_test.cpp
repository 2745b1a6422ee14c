#include "modules/runtime/cycle_budget.h"

#include <catch2/catch.hpp>
#include <cmath>

using palpate::runtime::CycleBudget;

namespace {

/// Wall time of an advance in sub-steps of at most `step` that cost `cost` each.
double wall_time(double simulated, double step, double cost) {
  return std::ceil(simulated / step - 1e-9) * cost;
}

}  // namespace

TEST_CASE("cycle budget: one that keeps up takes a period per cycle, an interruption included") {
  // Oracle: definition; 40 % busy, one cycle in ten interrupted for twice its period.
  CycleBudget budget(0.004, 0.0005);
  for (int i = 0; i < 100; ++i) {
    CHECK(budget.next() == 0.004);
    budget.took(0.004, i % 10 == 9 ? 0.0096 : 0.0016);
  }
}

TEST_CASE("cycle budget: one that cannot keep up does what fits into its period") {
  // Oracle: sub-steps of 0.4 ms that cost 2 ms: two fit into 4 ms.
  CycleBudget budget(0.004, 0.0004);
  double simulated = 0, wall = 0;
  for (int i = 0; i < 200; ++i) {
    simulated = budget.next();
    wall = wall_time(simulated, 0.0004, 0.002);
    budget.took(simulated, wall);
  }
  CHECK(wall <= 2 * 0.002);
  CHECK(simulated == Approx(0.0008).epsilon(0.05));
}

TEST_CASE("cycle budget: never less than a sub-step, and back to a period when load goes") {
  // Oracle: definition.
  CycleBudget budget(0.004, 0.0004);
  budget.took(0.004, 4.0);
  CHECK(budget.next() == 0.0004);
  for (int i = 0; i < 200; ++i) budget.took(budget.next(), 0.1 * budget.next());
  CHECK(budget.next() == 0.004);
  CHECK(CycleBudget(0.004, 0.01).next() == 0.004);
}
