// The bus's contract where every sample is kept, as in a lockstep: what holds of all buses.
#include <array>
#include <catch2/catch.hpp>

#include "tests/modules/bus/both_buses.h"

namespace palpate::bus {
using namespace testing;
namespace {

/// A writer and a reader of probe states, matched.
template <class Session>
struct EverySample {
  EverySample() { match(writer, reader); }
  void flush() { session.writers().flush(); }
  Session session{true};
  Writer<ProbeState> writer = session.writers().writer(kProbeState);
  Reader<ProbeState> reader = session.readers().reader(kProbeState);
};

// Of ten waits of 5 ms; packets that are no sample may end one or the other.
template <class Message>
int waits_ended(Reader<Message>& reader) {
  int ended = 0;
  for (int k = 0; k < 10; ++k) ended += reader.wait(0.005);
  return ended;
}

}  // namespace

TEMPLATE_TEST_CASE("bus contract: with every sample nothing is lost, and each key comes in order",
                   "[bus]", PALPATE_BOTH_BUSES) {
  // Oracle: the numbers 1 to 2000, more than any history of a stream holds, read at the end.
  EverySample<TestType> ends;
  constexpr std::size_t kSamples = 2000;
  ProbeState sent = state_at(1);
  for (std::size_t i = 0; i < kSamples; ++i) {
    sent.probe = static_cast<std::uint32_t>(i % 3);
    REQUIRE(ends.writer.write(sent));
  }
  ends.flush();
  const auto taken = take_all(ends.writer, ends.reader, kSamples);
  REQUIRE(taken.size() == kSamples);
  std::array<std::uint64_t, 3> next{1, 2, 3};
  for (const ProbeState& state : taken) {
    REQUIRE(state.header.sequence == next[state.probe]);
    next[state.probe] += next.size();
  }
  CHECK(ends.reader.statistics().dropped == 0);
}

TEMPLATE_TEST_CASE("bus contract: with every sample who is seen to read gets all from then on",
                   "[bus]", PALPATE_BOTH_BUSES) {
  // Oracle: the numbers; three samples that nobody reads are counted.
  TestType session(true);
  auto writer = session.writers().writer(kProbeState);
  for (int i = 0; i < 3; ++i) {
    ProbeState unread = state_at(1);
    REQUIRE(writer.write(unread));
    session.writers().flush();
  }
  auto reader = session.readers().reader(kProbeState);
  match(writer, reader);
  ProbeState sent = state_at(2);
  REQUIRE(writer.write(sent));
  session.writers().flush();
  const auto taken = take_all(writer, reader, 1);
  REQUIRE(taken.size() == 1);
  CHECK(taken[0].header.sequence == 4);
}

TEMPLATE_TEST_CASE("bus contract: with every sample large messages are not lost either", "[bus]",
                   PALPATE_BOTH_BUSES) {
  // Oracle: the numbers 1 to 50 of messages of 240 KB, each some fragments on a network.
  TestType session(true);
  auto writer = session.writers().writer(kNodePositions);
  auto reader = session.readers().reader(kNodePositions);
  match(writer, reader);
  NodePositions sent;
  sent.positions.assign(60'000, 0.25f);
  for (int i = 0; i < 50; ++i) REQUIRE(writer.write(sent));
  session.writers().flush();
  const auto taken = take_all(writer, reader, 50);
  REQUIRE(taken.size() == 50);
  for (std::size_t i = 0; i < 50; ++i) REQUIRE(taken[i].header.sequence == i + 1);
}

TEMPLATE_TEST_CASE("bus contract: samples beyond the horizon wait, in order", "[bus]",
                   PALPATE_BOTH_BUSES) {
  // Oracle: the source times written, 10 to 100 ns in steps of 10, of two keys. What was heard ends
  // no wait for more, taken or not.
  EverySample<TestType> ends;
  REQUIRE(ends.session.readers().inputs().size() == 1);
  Input& input = *ends.session.readers().inputs()[0];
  CHECK(input.topic().name == "probe_state");
  input.set_horizon(0);
  for (std::int64_t time = 10; time <= 100; time += 10) {
    ProbeState state = state_at(time, static_cast<std::uint32_t>(time / 10 % 2));
    REQUIRE(ends.writer.write(state));
  }
  ends.flush();
  REQUIRE(wait_until([&] { return input.heard_until(90, 2); }));
  CHECK(input.heard_until(100, 1));
  CHECK_FALSE(input.heard_until(100, 2));
  CHECK_FALSE(input.heard_until(101, 1));
  ProbeState received;
  CHECK_FALSE(ends.reader.take(received));
  std::int64_t last = 0;
  for (const std::int64_t horizon : {35, 40, 100}) {
    input.set_horizon(horizon);
    CHECK(waits_ended(ends.reader) < 5);
    while (ends.reader.take(received)) {
      CHECK(received.header.source_time_ns == last + 10);
      last = received.header.source_time_ns;
    }
    CHECK(last == horizon / 10 * 10);
  }
  CHECK(ends.reader.statistics().received == 10);
}

TEMPLATE_TEST_CASE("bus contract: nobody looks for more of what is all heard", "[bus]",
                   PALPATE_BOTH_BUSES) {
  // Oracle: a sample that was not heard when all was said to be heard is not handed out, until it
  // may be.
  EverySample<TestType> ends;
  const auto write = [&](std::int64_t time) {
    ProbeState state = state_at(time);
    REQUIRE(ends.writer.write(state));
    ends.flush();
  };
  write(10);
  REQUIRE(wait_until([&] { return ends.reader.input().heard_until(10); }));
  write(20);
  ProbeState received;
  ends.reader.input().set_horizon(100, true);
  REQUIRE(ends.reader.take(received));
  CHECK(received.header.source_time_ns == 10);
  ends.reader.wait(0.1);  // it has come
  CHECK_FALSE(ends.reader.take(received));
  ends.reader.input().set_horizon(100);
  REQUIRE(take_soon(ends.reader, received));
  CHECK(received.header.source_time_ns == 20);
}

TEMPLATE_TEST_CASE("bus contract: two writers' samples come by time, whoever was first", "[bus]",
                   PALPATE_BOTH_BUSES) {
  // Oracle: the order of source times, then keys; the second writer writes all of its after.
  TestType session(true);
  auto first = session.writers().writer(kProbeState);
  auto second = session.writers().writer(kProbeState);
  auto reader = session.readers().reader(kProbeState);
  match(first, reader, TestType::kStreamsOfTwoWriters);
  REQUIRE(wait_until([&] { return second.matched_readers() == 1; }));
  reader.input().set_horizon(0);
  for (const std::int64_t time : {10, 20, 30}) {
    ProbeState state = state_at(time, 1);
    REQUIRE(first.write(state));
  }
  for (const std::int64_t time : {5, 20, 25}) {
    ProbeState state = state_at(time, 0);
    REQUIRE(second.write(state));
  }
  session.writers().flush();
  REQUIRE(wait_until([&] { return reader.input().heard_until(25, 2); }));
  REQUIRE(wait_until([&] { return reader.input().heard_until(30, 1); }));
  reader.input().set_horizon(30);
  std::vector<std::pair<std::int64_t, std::uint32_t>> order;
  ProbeState received;
  while (reader.take(received)) order.emplace_back(received.header.source_time_ns, received.probe);
  CHECK(order == std::vector<std::pair<std::int64_t, std::uint32_t>>{
                     {5, 0}, {10, 1}, {20, 0}, {20, 1}, {25, 0}, {30, 1}});
}

}  // namespace palpate::bus
