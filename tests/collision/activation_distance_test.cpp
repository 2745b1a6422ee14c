#include "collision/activation_distance.h"

#include <catch2/catch.hpp>

namespace palpate::collision {
namespace {

TEST_CASE("contact margin: what moves at its speed is not met unseen") {
  // Oracle: the way in one period of each process.
  scene::Rates rates;
  for (const double rate : {50.0, 250.0, 1000.0}) {
    rates.collision = rates.deformation = rate;
    for (const double speed : {0.0, 0.1, 1.0}) {
      CHECK(activation_distance(rates, speed) >= (speed + 0.12) * 2 / rate);
    }
    CHECK(activation_distance(rates, 0) >= 1e-3);
  }
  CHECK(activation_distance(scene::Rates{}, 0) == Approx(1e-3));
}

}  // namespace
}  // namespace palpate::collision
