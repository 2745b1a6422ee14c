// A bus whose sockets are read by who waits (Arrivals::kPolled).
#include <catch2/catch.hpp>
#include <chrono>

#include "tests/modules/bus/loopback.h"

namespace palpate::bus {
namespace {

using testing::kDeadline;
using testing::own_options;
using testing::take_soon;
using testing::wait_until;

BusOptions every_sample_options() {
  BusOptions options = own_options();
  options.every_sample = true;
  return options;
}

double seconds_since(std::chrono::steady_clock::time_point then) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - then).count();
}

}  // namespace

TEST_CASE("polled bus: who waits for one topic is told of a sample that was heard for another",
          "[bus]") {
  // Oracle: the clock: the sample is there before the wait, which may last as long as a test may.
  // The second topic's reader looks into the sockets until the first one's sample must have come:
  // its own was written after it.
  const BusOptions options = every_sample_options();
  DdsBus far(options), polled(options, Arrivals::kPolled);
  auto first = far.writer(kSessionControl);
  auto second = far.writer(kModuleStatus);
  auto first_reader = polled.reader(kSessionControl);
  auto second_reader = polled.reader(kModuleStatus);
  REQUIRE(wait_until([&] {
    return first.matched_readers() == 1 && second.matched_readers() == 1 &&
           first_reader.matched_writers() == 1 && second_reader.matched_writers() == 1;
  }));
  SessionControl command;
  ModuleStatus status;
  status.module = "haptics";
  REQUIRE(first.write(command));
  REQUIRE(second.write(status));
  REQUIRE(take_soon(second_reader, status));
  const auto began = std::chrono::steady_clock::now();
  CHECK(first_reader.wait(kDeadline));
  CHECK(seconds_since(began) < kDeadline / 2);
  CHECK(first_reader.take(command));
}

TEST_CASE("polled bus: who waits until a state is received hears of it, and else gives up in time",
          "[bus]") {
  // Oracle: a reader that hears at once, and one on a polled bus that nobody lets hear.
  const BusOptions options = every_sample_options();
  DdsBus polled(options, Arrivals::kPolled);
  auto writer = polled.writer(kSessionControl);
  SessionControl command;
  {
    DdsBus hears(options);
    auto reader = hears.reader(kSessionControl);
    REQUIRE(wait_until([&] { return writer.matched_readers() == 1; }));
    REQUIRE(writer.write(command));
    CHECK(writer.wait_until_received(kDeadline));
  }
  REQUIRE(wait_until([&] { return writer.matched_readers() == 0; }));
  DdsBus deaf(options, Arrivals::kPolled);
  auto reader = deaf.reader(kSessionControl);
  REQUIRE(wait_until([&] { return writer.matched_readers() == 1; }));
  REQUIRE(writer.write(command));
  const auto began = std::chrono::steady_clock::now();
  CHECK_FALSE(writer.wait_until_received(0.1));
  CHECK(seconds_since(began) >= 0.1);
  bool taken = false;
  CHECK(wait_until([&] {
    taken |= reader.take(command);
    return writer.wait_until_received(0.001);
  }));
  CHECK(taken);
}

}  // namespace palpate::bus
