// One contract, two buses, one of them heard in three ways: what holds of any is tested on all.
#include <catch2/catch.hpp>
#include <cmath>
#include <map>

#include "tests/modules/bus/both_buses.h"
#include "tests/modules/messages/random_messages.h"

namespace palpate::bus {
namespace {

using messages::testing::equal;
using messages::testing::Random;
using messages::testing::random_message;
using testing::DdsSession;
using testing::GatheredSession;
using testing::match;
using testing::MemorySession;
using testing::PolledSession;
using testing::take_soon;
using testing::wait_until;

ProbeState state_at(std::int64_t source_time_ns, std::uint32_t probe = 0) {
  ProbeState state;
  state.header.source_time_ns = source_time_ns;
  state.probe = probe;
  return state;
}

// Of ten waits of 5 ms; packets that are no sample may end one or the other.
template <class Message>
int waits_ended(Reader<Message>& reader) {
  int ended = 0;
  for (int k = 0; k < 10; ++k) ended += reader.wait(0.005);
  return ended;
}

// Everything that arrives until `count` samples came; the writer waits for it in turns, as there is
// no room for all of it on the way.
template <class Message>
std::vector<Message> take_all(Writer<Message>& writer, Reader<Message>& reader, std::size_t count) {
  std::vector<Message> taken;
  Message message;
  wait_until([&] {
    writer.wait_until_received(0.001);
    while (reader.take(message)) taken.push_back(message);
    return taken.size() >= count;
  });
  return taken;
}

}  // namespace

TEMPLATE_TEST_CASE("bus contract: what was written arrives, bit by bit, and is counted", "[bus]",
                   PALPATE_BOTH_BUSES) {
  // Oracle: identity with the message sent.
  TestType session;
  auto writer = session.writers().writer(kContacts);
  auto reader = session.readers().reader(kContacts);
  match(writer, reader);
  Random random(1);
  Contacts received;
  for (std::uint64_t i = 1; i <= 5; ++i) {
    auto sent = random_message<Contacts>(random);
    REQUIRE(writer.write(sent));
    CHECK(sent.header.sequence == i);
    REQUIRE(take_soon(reader, received));
    CHECK(equal(sent, received));
  }
  CHECK(reader.statistics().received == 5);
  CHECK(reader.statistics().dropped == 0);
  CHECK_FALSE(reader.take(received));
}

TEMPLATE_TEST_CASE("bus contract: a busy reader finds the newest sample of each key", "[bus]",
                   PALPATE_BOTH_BUSES) {
  // Oracle: the last message written per probe; the replaced ones are counted as dropped.
  TestType session;
  auto writer = session.writers().writer(kProbeState);
  auto reader = session.readers().reader(kProbeState);
  match(writer, reader);
  ProbeState sent = state_at(1), received;
  REQUIRE(writer.write(sent));  // gaps are counted from the first sample taken
  REQUIRE(take_soon(reader, received));
  constexpr std::uint64_t kSamples = 20;
  for (std::uint64_t i = 1; i <= kSamples; ++i) {
    sent.probe = static_cast<std::uint32_t>(i % 2);
    sent.pose.position.x() = static_cast<double>(i);
    REQUIRE(writer.write(sent));
  }
  // A last sample of a third key tells that all before it have arrived (one socket, in order).
  sent.probe = 2;
  REQUIRE(writer.write(sent));
  std::array<double, 3> newest{};
  REQUIRE(wait_until([&] {
    while (reader.take(received)) newest[received.probe] = received.pose.position.x();
    return newest[2] != 0;
  }));
  CHECK(newest[0] == kSamples);
  CHECK(newest[1] == kSamples - 1);
  CHECK(reader.statistics().received + reader.statistics().dropped == 1 + kSamples + 1);
}

TEMPLATE_TEST_CASE("bus contract: a reader with a backlog gets all that came while it was busy",
                   "[bus]", PALPATE_BOTH_BUSES) {
  // Oracle: the values sent, in order; fewer than the backlog holds.
  TestType session;
  auto writer = session.writers().writer(kHapticForce);
  auto reader = session.readers().reader(kHapticForce, Keep::kBacklog);
  match(writer, reader);
  constexpr int kCount = 100;
  static_assert(kCount < kBacklogDepth);
  HapticForce force;
  for (int i = 0; i < kCount; ++i) {
    force.force.x() = i;
    REQUIRE(writer.write(force));
  }
  int next = 0;
  REQUIRE(wait_until([&] {
    while (reader.take(force)) {
      CHECK(force.force.x() == next);
      ++next;
    }
    return next == kCount;
  }));
  CHECK(reader.statistics().dropped == 0);
}

TEMPLATE_TEST_CASE("bus contract: late readers get the newest state per key and no old stream",
                   "[bus]", PALPATE_BOTH_BUSES) {
  // Oracle: identity with the last message of each key; a stream is volatile.
  TestType session;
  auto writer = session.writers().writer(kModuleStatus);
  auto stream = session.writers().writer(kHapticForce);
  Random random(2);
  std::map<std::string, ModuleStatus> last;
  for (const char* name : {"a", "b", "a", "b", "a"}) {
    auto status = random_message<ModuleStatus>(random);
    status.module = name;
    REQUIRE(writer.write(status));
    last[name] = status;
  }
  HapticForce force, heard;
  REQUIRE(stream.write(force));
  auto reader = session.readers().reader(kModuleStatus);
  auto forces = session.readers().reader(kHapticForce);
  const auto taken = take_all(writer, reader, 2);
  REQUIRE(taken.size() == 2);
  for (const ModuleStatus& status : taken) CHECK(equal(status, last.at(status.module)));
  match(stream, forces);
  CHECK_FALSE(forces.take(heard));
}

TEMPLATE_TEST_CASE("bus contract: what is not valid never leaves, and takes no number", "[bus]",
                   PALPATE_BOTH_BUSES) {
  // Oracle: the message checks; the reader sees only the valid samples, numbered 1 and 2.
  TestType session;
  auto writer = session.writers().writer(kHapticForce);
  auto reader = session.readers().reader(kHapticForce);
  match(writer, reader);
  HapticForce sent, received;
  REQUIRE(writer.write(sent));
  CHECK(writer.statistics().refused == 0);
  REQUIRE(take_soon(reader, received));
  sent.force.y() = std::nan("");
  CHECK_FALSE(writer.write(sent));
  CHECK(writer.statistics().refused == 1);
  CHECK(std::string(writer.statistics().last_refused_field) == "force_n");
  sent.force.y() = 1;
  REQUIRE(writer.write(sent));
  REQUIRE(take_soon(reader, received));
  CHECK(received.header.sequence == 2);
  CHECK(reader.statistics().dropped == 0);
}

TEMPLATE_TEST_CASE("bus contract: a payload that cannot be read is counted and skipped", "[bus]",
                   PALPATE_BOTH_BUSES) {
  // Oracle: the rules of idl/README.md; the good sample after the bad ones arrives.
  TestType session;
  auto raw = session.writers().raw_writer(info_of(kProbeInput));
  auto reader = session.readers().reader(kProbeInput);
  REQUIRE(wait_until([&] { return raw->matched_readers() == 1 && reader.matched_writers() == 1; }));
  ProbeState state = state_at(5);
  ProbeState received;
  const auto send = [&](std::uint64_t sequence, double x, std::size_t bytes) {
    state.header.sequence = sequence;
    state.pose.position.x() = x;
    auto payload = messages::testing::payload_of(state);
    payload.resize(std::min(bytes, payload.size()));
    REQUIRE(raw->write(payload));
  };
  const auto rejected_for = [&](std::uint64_t count) {
    REQUIRE(wait_until(
        [&] { return !reader.take(received) && reader.statistics().rejected == count; }));
    return std::string(reader.statistics().last_rejected_field);
  };
  send(1, std::nan(""), 1000);
  CHECK(rejected_for(1) == "position_m");
  send(2, 0, 40);
  CHECK(rejected_for(2) == "payload");
  send(4, 7, 1000);
  REQUIRE(take_soon(reader, received));
  CHECK(received.pose.position.x() == 7);
  CHECK(reader.statistics().received == 1);
}

TEMPLATE_TEST_CASE("bus contract: gaps in the numbers of each of two writers are counted", "[bus]",
                   PALPATE_BOTH_BUSES) {
  // Oracle: the gap made by hand, 2 to 6, and a second writer without one.
  TestType session;
  auto first = session.writers().raw_writer(info_of(kProbeInput));
  auto second = session.writers().raw_writer(info_of(kProbeInput));
  auto reader = session.readers().reader(kProbeInput);
  REQUIRE(wait_until([&] {
    return first->matched_readers() == 1 && second->matched_readers() == 1 &&
           reader.matched_writers() == 2;
  }));
  ProbeState received;
  const auto send = [&](RawWriter& writer, std::uint64_t sequence) {
    ProbeState state = state_at(1);
    state.header.sequence = sequence;
    REQUIRE(writer.write(messages::testing::payload_of(state)));
    REQUIRE(take_soon(reader, received));
  };
  send(*first, 1);
  send(*second, 1);
  send(*first, 7);
  send(*second, 2);
  CHECK(reader.statistics().received == 4);
  CHECK(reader.statistics().dropped == 5);
}

TEMPLATE_TEST_CASE("bus contract: with every sample nothing is lost, and each key comes in order",
                   "[bus]", PALPATE_BOTH_BUSES) {
  // Oracle: the numbers 1 to 2000, more than any history of a stream holds, read at the end.
  TestType session(true);
  auto writer = session.writers().writer(kProbeState);
  auto reader = session.readers().reader(kProbeState);
  match(writer, reader);
  constexpr std::size_t kSamples = 2000;
  ProbeState sent = state_at(1);
  for (std::size_t i = 0; i < kSamples; ++i) {
    sent.probe = static_cast<std::uint32_t>(i % 3);
    REQUIRE(writer.write(sent));
  }
  session.writers().flush();
  const auto taken = take_all(writer, reader, kSamples);
  REQUIRE(taken.size() == kSamples);
  std::array<std::uint64_t, 3> next{1, 2, 3};
  for (const ProbeState& state : taken) {
    REQUIRE(state.header.sequence == next[state.probe]);
    next[state.probe] += next.size();
  }
  CHECK(reader.statistics().dropped == 0);
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
  TestType session(true);
  auto writer = session.writers().writer(kProbeState);
  auto reader = session.readers().reader(kProbeState);
  match(writer, reader);
  REQUIRE(session.readers().inputs().size() == 1);
  Input& input = *session.readers().inputs()[0];
  CHECK(input.topic().name == "probe_state");
  input.set_horizon(0);
  for (std::int64_t time = 10; time <= 100; time += 10) {
    ProbeState state = state_at(time, static_cast<std::uint32_t>(time / 10 % 2));
    REQUIRE(writer.write(state));
  }
  session.writers().flush();
  REQUIRE(wait_until([&] { return input.heard_until(90, 2); }));
  CHECK(input.heard_until(100, 1));
  CHECK_FALSE(input.heard_until(100, 2));
  CHECK_FALSE(input.heard_until(101, 1));
  ProbeState received;
  CHECK_FALSE(reader.take(received));
  std::int64_t last = 0;
  for (const std::int64_t horizon : {35, 40, 100}) {
    input.set_horizon(horizon);
    CHECK(waits_ended(reader) < 5);
    while (reader.take(received)) {
      CHECK(received.header.source_time_ns == last + 10);
      last = received.header.source_time_ns;
    }
    CHECK(last == horizon / 10 * 10);
  }
  CHECK(reader.statistics().received == 10);
}

TEMPLATE_TEST_CASE("bus contract: nobody looks for more of what is all heard", "[bus]",
                   PALPATE_BOTH_BUSES) {
  // Oracle: a sample that was not heard when all was said to be heard is not handed out, until it
  // may be.
  TestType session(true);
  auto writer = session.writers().writer(kProbeState);
  auto reader = session.readers().reader(kProbeState);
  match(writer, reader);
  const auto write = [&](std::int64_t time) {
    ProbeState state = state_at(time);
    REQUIRE(writer.write(state));
    session.writers().flush();
  };
  write(10);
  REQUIRE(wait_until([&] { return reader.input().heard_until(10); }));
  write(20);
  ProbeState received;
  reader.input().set_horizon(100, true);
  REQUIRE(reader.take(received));
  CHECK(received.header.source_time_ns == 10);
  reader.wait(0.1);  // it has come
  CHECK_FALSE(reader.take(received));
  reader.input().set_horizon(100);
  REQUIRE(take_soon(reader, received));
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

TEMPLATE_TEST_CASE("bus contract: the bus's clock stamps what its writer did not", "[bus]",
                   PALPATE_BOTH_BUSES) {
  // Oracle: the clock given.
  TestType session;
  session.writers().set_clock([] { return std::int64_t{1234}; });
  auto writer = session.writers().writer(kProbeState);
  auto reader = session.readers().reader(kProbeState);
  match(writer, reader);
  ProbeState sent, received;
  REQUIRE(writer.write(sent));
  CHECK(sent.header.source_time_ns == 0);
  REQUIRE(take_soon(reader, received));
  CHECK(received.header.source_time_ns == 1234);
  sent.header.source_time_ns = 42;
  REQUIRE(writer.write(sent));
  REQUIRE(take_soon(reader, received));
  CHECK(received.header.source_time_ns == 42);
  CHECK(reader.statistics().newest_source_time_ns == 1234);
}

TEMPLATE_TEST_CASE("bus contract: readers and writers come and go", "[bus]", PALPATE_BOTH_BUSES) {
  // Oracle: the counts of matched ends, and of the bus's inputs.
  TestType session;
  auto writer = session.writers().writer(kSessionControl);
  {
    auto reader = session.readers().reader(kSessionControl);
    auto moved = std::move(reader);
    match(writer, moved);
    CHECK(session.readers().inputs().size() == 1);
  }
  CHECK(session.readers().inputs().empty());
  CHECK(wait_until([&] { return writer.matched_readers() == 0; }));
}

}  // namespace palpate::bus
