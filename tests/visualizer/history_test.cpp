#include "visualizer/history.h"

#include <catch2/catch.hpp>

using palpate::visualizer::History;

TEST_CASE("history: keeps the newest samples in order when full", "[visualizer]") {
  // Oracle: analytic. 10 samples into a ring of 4 leave the last 4.
  History history(4, 0.5);
  for (int i = 0; i < 10; ++i) history.push(i, 10 * i);
  REQUIRE(history.size() == 4);
  for (std::size_t i = 0; i < 4; ++i) {
    CHECK(history.at(i).time == 6.0 + double(i));
    CHECK(history.at(i).value == 10 * (6.0 + double(i)));
  }
  CHECK(history.newest().time == 9);
}

TEST_CASE("history: close samples share a slot and keep their peaks", "[visualizer]") {
  // Oracle: by hand. Of a slot the newest, the least and the greatest stay.
  History history(10, 0.1);
  history.push(0.00, 1);
  history.push(0.03, -7);
  history.push(0.06, 2);
  history.push(0.12, 3);
  REQUIRE(history.size() == 2);
  CHECK(history.at(0).value == 2);
  CHECK(history.at(0).least == -7);
  CHECK(history.at(0).greatest == 2);
  CHECK(history.at(0).time == 0.06);
  CHECK(history.at(1).value == 3);
}

TEST_CASE("history: a stream of close samples still advances", "[visualizer]") {
  // Oracle: analytic. 1000 samples 1 ms apart with 10 ms spacing: slots of 10, so 100 remain.
  History history(2048, 0.01);
  for (int i = 0; i < 1000; ++i) history.push(1e-3 * i + 1e-7, 1);
  CHECK(history.size() >= 90);
  CHECK(history.size() <= 101);
}

TEST_CASE("history: time going back starts again", "[visualizer]") {
  // Oracle: the stated rule for a reset session.
  History history(4, 0.5);
  for (int i = 0; i < 6; ++i) history.push(i, i);
  history.push(0, 42);
  REQUIRE(history.size() == 1);
  CHECK(history.newest().value == 42);
}
