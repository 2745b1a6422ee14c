#include "modules/bus/dds_bus.h"

#include <unistd.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "modules/core/error.h"
#include "tests/modules/bus/loopback.h"
#include "tests/modules/messages/random_messages.h"

namespace palpate::bus {
namespace {

using messages::testing::Random;
using messages::testing::random_message;
using testing::own_options;
using testing::Pair;
using testing::take_soon;
using testing::wait_until;

// Sends random messages, one at a time, and compares what arrives.
template <class Message>
void check_delivery(const TopicOf<Message>& topic) {
  CAPTURE(topic.name);
  Pair<Message> pair(topic);
  REQUIRE(pair.matched);
  Random random(1);
  for (std::uint64_t i = 1; i <= 5; ++i) {
    Message sent = random_message<Message>(random);
    REQUIRE(pair.writer.write(sent));
    CHECK(sent.header.sequence == i);
    Message received;
    REQUIRE(take_soon(pair.reader, received));
    CHECK(messages::testing::equal(sent, received));
  }
  CHECK(pair.reader.statistics().received == 5);
  CHECK(pair.reader.statistics().dropped == 0);
  CHECK(pair.reader.statistics().rejected == 0);
}

// A topic's samples a millisecond or two apart, read as a recorder reads.
template <class Message>
void check_arrivals(const TopicOf<Message>& topic) {
  CAPTURE(topic.name);
  const BusOptions options = own_options();
  DdsBus writer_bus(options), reader_bus(options, Arrivals::kGathered);
  auto writer = writer_bus.writer(topic);
  const auto reader = reader_bus.raw_reader(info_of(topic), Keep::kBacklog);
  REQUIRE(
      wait_until([&] { return writer.matched_readers() == 1 && reader->matched_writers() == 1; }));
  std::vector<std::int64_t> before, arrived;
  RawSample sample;
  Random random(1);
  Message message = random_message<Message>(random);  // of one key, that it may be taken in order
  constexpr std::size_t kCount = 100;
  for (std::size_t k = 0; k < kCount; ++k) {
    before.push_back(writer_bus.now_ns());
    REQUIRE(writer.write(message));
    usleep(1'500);
  }
  REQUIRE(wait_until([&] {
    while (reader->take(sample)) arrived.push_back(sample.received_time_ns);
    return arrived.size() >= kCount;
  }));
  REQUIRE(arrived.size() == kCount);
  std::size_t in_time = 0;
  for (std::size_t k = 0; k + 1 < kCount; ++k) {
    in_time += arrived[k] > before[k] - 100'000 && arrived[k] < before[k + 1];
  }
  CHECK(in_time > kCount / 2);
}

}  // namespace

TEST_CASE("bus: what is gathered bears the time of its arrival, not of its reading", "[bus]") {
  // Oracle: the clock before each sample was written and before the next one was. Gathered every
  // 20 ms, samples stamped when they are read would be one in thirteen within that. A tenth of a
  // millisecond is for the two clocks. By the shortcut and by the library, which hears states.
  check_arrivals(kHapticForce);
  check_arrivals(kModuleStatus);
}

TEST_CASE("bus: a state that was written before its gathering reader came arrived after that",
          "[bus]") {
  // Oracle: the clock when the reader was made. The packet bears the time of writing, and that was
  // before.
  const BusOptions options = own_options();
  DdsBus writer_bus(options);
  auto writer = writer_bus.writer(kSessionControl);
  SessionControl control;
  REQUIRE(writer.write(control));
  usleep(50'000);
  const std::int64_t before = writer_bus.now_ns();
  DdsBus reader_bus(options, Arrivals::kGathered);
  const auto reader = reader_bus.raw_reader(info_of(kSessionControl), Keep::kBacklog);
  RawSample sample;
  REQUIRE(wait_until([&] { return reader->take(sample); }));
  CHECK(sample.received_time_ns > before);
  CHECK(sample.received_time_ns < writer_bus.now_ns());
}

TEST_CASE("bus: what is gathered is whole, in many datagrams too, and of every writer", "[bus]") {
  // Oracle: identity with the messages sent, before and after a second writer came and left.
  const BusOptions options = own_options();
  DdsBus writer_bus(options), reader_bus(options, Arrivals::kGathered);
  auto reader = reader_bus.reader(kNodePositions, Keep::kBacklog);
  auto writer = writer_bus.writer(kNodePositions);
  const auto check = [&](bus::Writer<NodePositions>& from, std::size_t nodes) {
    NodePositions sent, received;
    sent.header.source_time_ns = 1;  // else it is the time of writing
    sent.positions.assign(3 * nodes, 0.25f);
    REQUIRE(from.write(sent));
    REQUIRE(take_soon(reader, received));
    CHECK(messages::testing::equal(sent, received));
  };
  REQUIRE(wait_until([&] { return writer.matched_readers() == 1; }));
  REQUIRE(wait_until([&] { return reader.matched_writers() == 1; }));
  for (const std::size_t nodes : {10u, 19'362u, 550u, 19'362u, 1u}) check(writer, nodes);
  {
    DdsBus second_bus(options);
    auto second = second_bus.writer(kNodePositions);
    REQUIRE(wait_until([&] { return second.matched_readers() == 1; }));
    REQUIRE(wait_until([&] { return reader.matched_writers() == 2; }));
    check(second, 20);
    check(writer, 30);
  }
  REQUIRE(wait_until([&] { return reader.matched_writers() == 1; }));
  check(writer, 40);
  CHECK(reader.statistics().dropped == 0);
  CHECK(reader_bus.packets_refused().count == 0);
}

TEST_CASE("bus: every topic delivers what was sent, over the loopback network", "[bus]") {
  // Oracle: identity with the message sent.
  check_delivery(kScene);
  check_delivery(kSurface);
  check_delivery(kNodePositions);
  check_delivery(kProbeState);
  check_delivery(kProbeInput);
  check_delivery(kContacts);
  check_delivery(kContactModel);
  check_delivery(kHapticForce);
  check_delivery(kModuleStatus);
  check_delivery(kSessionControl);
}

TEST_CASE("bus: a late reader gets the newest sample of each key of a state topic", "[bus]") {
  // Oracle: identity with the last message sent per key.
  const BusOptions options = own_options();
  DdsBus writer_bus(options);
  auto writer = writer_bus.writer(kModuleStatus);
  Random random(2);
  const std::string a("a"), b("b");
  ModuleStatus last_of_a, last_of_b;
  for (int i = 0; i < 3; ++i) {
    last_of_a = random_message<ModuleStatus>(random);
    last_of_a.module = a;
    REQUIRE(writer.write(last_of_a));
    last_of_b = random_message<ModuleStatus>(random);
    last_of_b.module = b;
    REQUIRE(writer.write(last_of_b));
  }

  DdsBus reader_bus(options);
  auto reader = reader_bus.reader(kModuleStatus);
  ModuleStatus first, second, third;
  REQUIRE(take_soon(reader, first));
  REQUIRE(take_soon(reader, second));
  if (first.module == b) std::swap(first, second);
  CHECK(messages::testing::equal(first, last_of_a));
  CHECK(messages::testing::equal(second, last_of_b));
  CHECK_FALSE(reader.take(third));
}

TEST_CASE("bus: a late reader gets nothing old from a stream", "[bus]") {
  // Oracle: the definition of a volatile topic: only what is written after the match arrives.
  const BusOptions options = own_options();
  DdsBus writer_bus(options), reader_bus(options);
  auto writer = writer_bus.writer(kHapticForce);
  HapticForce before, after, received;
  before.force.x() = 1;
  after.force.x() = 2;
  REQUIRE(writer.write(before));
  auto reader = reader_bus.reader(kHapticForce);
  REQUIRE(
      wait_until([&] { return writer.matched_readers() == 1 && reader.matched_writers() == 1; }));
  REQUIRE(writer.write(after));
  REQUIRE(take_soon(reader, received));
  CHECK(received.force.x() == 2);
}

TEST_CASE("bus: a reader that comes late to a stream takes only the newest sample of each key",
          "[bus]") {
  // Oracle: the last message written per probe; the replaced ones are counted as dropped.
  Pair<ProbeState> pair(kProbeState);
  REQUIRE(pair.matched);
  ProbeState sent, received;
  REQUIRE(pair.writer.write(sent));  // gaps are counted from the first sample taken
  REQUIRE(take_soon(pair.reader, received));
  constexpr std::uint64_t kSamples = 20;
  for (std::uint64_t i = 1; i <= kSamples; ++i) {
    sent.probe = static_cast<std::uint32_t>(i % 2);
    sent.pose.position.x() = static_cast<double>(i);
    REQUIRE(pair.writer.write(sent));
  }
  // A last sample of a third key tells that all before it have arrived (one socket, in order).
  sent.probe = 2;
  REQUIRE(pair.writer.write(sent));
  std::array<double, 3> newest{};
  REQUIRE(wait_until([&] {
    while (pair.reader.take(received)) newest[received.probe] = received.pose.position.x();
    return newest[2] != 0;
  }));
  CHECK(newest[0] == kSamples);
  CHECK(newest[1] == kSamples - 1);
  const ReaderStatistics& statistics = pair.reader.statistics();
  CHECK(statistics.received + statistics.dropped == 1 + kSamples + 1);
}

TEST_CASE("bus: two sessions in one domain do not hear each other", "[bus]") {
  // Oracle: the two readers' counts; a second sample in the own session shows when to look.
  const BusOptions one = own_options();
  BusOptions other = own_options();
  other.domain = one.domain;
  Pair<SessionControl> pair(kSessionControl, one);
  Pair<SessionControl> other_pair(kSessionControl, other);
  REQUIRE(pair.matched);
  REQUIRE(other_pair.matched);
  SessionControl control, received;
  control.reset_count = 1;
  REQUIRE(pair.writer.write(control));
  REQUIRE(take_soon(pair.reader, received));
  control.reset_count = 2;
  REQUIRE(other_pair.writer.write(control));
  REQUIRE(take_soon(other_pair.reader, received));
  CHECK(received.reset_count == 2);
  CHECK(other_pair.reader.statistics().received == 1);
  CHECK(pair.writer.matched_readers() == 1);
  CHECK_FALSE(pair.reader.take(received));
}

TEST_CASE("bus: two participants of one session hear a writer both", "[bus]") {
  // Oracle: identity with the message sent.
  const BusOptions options = own_options();
  Pair<ProbeState> pair(kProbeState, options);
  DdsBus third(options);
  auto reader = third.reader(kProbeState);
  REQUIRE(wait_until(
      [&] { return pair.writer.matched_readers() == 2 && reader.matched_writers() == 1; }));
  Random random(3);
  ProbeState sent = random_message<ProbeState>(random), a, b;
  REQUIRE(pair.writer.write(sent));
  REQUIRE(take_soon(pair.reader, a));
  REQUIRE(take_soon(reader, b));
  CHECK(messages::testing::equal(sent, a));
  CHECK(messages::testing::equal(sent, b));
}

TEST_CASE("bus: wait returns at once when a sample is there and gives up at its timeout", "[bus]") {
  // Oracle: the contract of wait, and the clock.
  Pair<ProbeState> pair(kProbeState);
  REQUIRE(pair.matched);
  const auto start = std::chrono::steady_clock::now();
  CHECK_FALSE(pair.reader.wait(0.05));
  CHECK(std::chrono::steady_clock::now() - start >= std::chrono::milliseconds(50));
  ProbeState message;
  REQUIRE(pair.writer.write(message));
  REQUIRE(pair.reader.wait(testing::kDeadline));
  CHECK(pair.reader.take(message));
  CHECK_FALSE(pair.reader.wait(0));
}

TEST_CASE("bus: a message without a source time carries the time of writing", "[bus]") {
  // Oracle: the monotonic clock read before and after.
  const auto now_ns = [] {
    return std::chrono::nanoseconds(std::chrono::steady_clock::now().time_since_epoch()).count();
  };
  Pair<ProbeState> pair(kProbeState);
  REQUIRE(pair.matched);
  ProbeState sent, received;
  const std::int64_t before = now_ns();
  REQUIRE(pair.writer.write(sent));
  const std::int64_t after = now_ns();
  CHECK(sent.header.source_time_ns == 0);
  REQUIRE(take_soon(pair.reader, received));
  CHECK(received.header.source_time_ns >= before);
  CHECK(received.header.source_time_ns <= after);
  CHECK(pair.reader.statistics().newest_source_time_ns == received.header.source_time_ns);

  sent.header.source_time_ns = 42;
  REQUIRE(pair.writer.write(sent));
  REQUIRE(take_soon(pair.reader, received));
  CHECK(received.header.source_time_ns == 42);
}

TEST_CASE("bus: a message that is not valid never leaves, and takes no sequence number", "[bus]") {
  // Oracle: the message checks; the reader sees only the valid samples, numbered 1 and 2.
  Pair<HapticForce> pair(kHapticForce);
  REQUIRE(pair.matched);
  HapticForce sent, received;
  REQUIRE(pair.writer.write(sent));
  CHECK(pair.writer.statistics().refused == 0);
  REQUIRE(take_soon(pair.reader, received));
  sent.force.y() = std::nan("");
  CHECK_FALSE(pair.writer.write(sent));
  CHECK(pair.writer.statistics().refused == 1);
  CHECK(std::string(pair.writer.statistics().last_refused_field) == "force_n");
  sent.force.y() = 1;
  REQUIRE(pair.writer.write(sent));
  REQUIRE(take_soon(pair.reader, received));
  CHECK(received.header.sequence == 2);
  CHECK(pair.reader.statistics().dropped == 0);
}

TEST_CASE("bus: in lockstep what travels together leaves topic by topic as the writers were made",
          "[bus]") {
  // Oracle: when they come. A datagram that a busy machine drops is sent again and comes late, so
  // most flushes are to be in order; the other way round one in twenty was.
  BusOptions options = testing::own_options();
  options.every_sample = true;
  DdsBus from(options), to(options);
  auto first = from.writer(kProbeState);
  auto second = from.writer(kHapticForce);  // before the other by its name
  const auto of_first = to.raw_reader(info_of(kProbeState), Keep::kNewest);
  const auto of_second = to.raw_reader(info_of(kHapticForce), Keep::kNewest);
  REQUIRE(
      wait_until([&] { return first.matched_readers() == 1 && second.matched_readers() == 1; }));
  constexpr int kFlushes = 20;
  int in_order = 0;
  for (int flush = 0; flush < kFlushes; ++flush) {
    HapticForce force;
    ProbeState state;
    REQUIRE(second.write(force));
    REQUIRE(first.write(state));
    from.flush();
    RawSample early, late;
    REQUIRE(wait_until([&] { return of_second->take(late); }));
    REQUIRE(wait_until([&] { return of_first->take(early); }));
    if (early.received_time_ns < late.received_time_ns) ++in_order;
  }
  CHECK(in_order > kFlushes / 2);
}

TEST_CASE("bus: domains and session names that are not acceptable are refused by name", "[bus]") {
  // Oracle: the texts that the contract promises.
  const auto message_of = [](const BusOptions& options) -> std::string {
    try {
      DdsBus bus(options);
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  const auto refused = [](const std::string& session) {
    std::string text("session: \"");
    text.append(session).append("\": allowed are 1 to 64 letters, digits, '_', '-', '.'");
    return text;
  };
  CHECK(message_of({.domain = -1}) == "domain: -1: allowed are 0 to 200");
  CHECK(message_of({.domain = 201}) == "domain: 201: allowed are 0 to 200");
  for (const std::string& session : {std::string(), std::string("a*"), std::string(65, 'x')}) {
    CHECK(message_of({.session = session}) == refused(session));
  }
}

}  // namespace palpate::bus
