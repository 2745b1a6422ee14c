// One contract, two buses, one of them heard in three ways: what holds of any is tested on all.
#include <catch2/catch.hpp>
#include <cmath>
#include <map>

#include "tests/modules/bus/both_buses.h"
#include "tests/modules/messages/random_messages.h"

namespace palpate::bus {

using messages::testing::equal;
using messages::testing::Random;
using messages::testing::random_message;
using namespace testing;

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
