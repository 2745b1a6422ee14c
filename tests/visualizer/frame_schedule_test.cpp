#include "visualizer/frame_schedule.h"

#include <catch2/catch.hpp>
#include <vector>

#include "tests/scratch_folder.h"

using namespace palpate::visualizer;

TEST_CASE("frame schedule: one picture per interval, at the first chance", "[visualizer]") {
  // Oracle: brute force count. 30 Hz for 10 s with an interval of 1 s: one in each second.
  FrameSchedule schedule(1.0);
  std::vector<double> made;
  for (int i = 0; i < 300; ++i) {
    if (schedule.take_due(i / 30.0)) made.push_back(i / 30.0);
  }
  REQUIRE(made.size() == 10);
  for (std::size_t i = 0; i < made.size(); ++i) {
    CHECK(made[i] >= double(i));
    CHECK(made[i] < double(i) + 1 / 30.0 + 1e-9);
  }
}

TEST_CASE("frame schedule: a late picture does not cause a burst", "[visualizer]") {
  // Oracle: the stated rule.
  FrameSchedule schedule(0.1);
  CHECK(schedule.take_due(0));
  CHECK(schedule.take_due(0.95));
  CHECK_FALSE(schedule.take_due(0.96));
  CHECK(schedule.take_due(1.0));
}

TEST_CASE("frame schedule: a reset session starts again", "[visualizer]") {
  // Oracle: the stated rule.
  FrameSchedule schedule(1.0);
  CHECK(schedule.take_due(7.3));
  CHECK(schedule.take_due(0.0));
  CHECK_FALSE(schedule.take_due(0.4));
}

TEST_CASE("frame names: hold the time and sort by it", "[visualizer]") {
  // Oracle: worked by hand.
  CHECK(frame_name(12.5) == "frame_000012.500.png");
  CHECK(frame_name(0) == "frame_000000.000.png");
  CHECK(frame_name(9.9995).string() < frame_name(100.25).string());
}

TEST_CASE("frame names: no picture takes the place of another", "[visualizer]") {
  // Oracle: worked by hand.
  const palpate::ScratchFolder folder;
  const auto wished = folder / "palpate_frame_000012.500.png";
  CHECK(unused_name(wished) == wished);
  folder.write("palpate_frame_000012.500.png", "");
  CHECK(unused_name(wished) == folder / "palpate_frame_000012.500-2.png");
  folder.write("palpate_frame_000012.500-2.png", "");
  CHECK(unused_name(wished) == folder / "palpate_frame_000012.500-3.png");
}
