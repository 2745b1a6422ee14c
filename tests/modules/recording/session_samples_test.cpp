#include "modules/recording/session_samples.h"

#include <catch2/catch.hpp>
#include <set>

#include "tests/modules/bus/loopback.h"
#include "tests/modules/messages/random_messages.h"
#include "tests/modules/recording/payloads.h"

namespace palpate::recording {
namespace {

using bus::testing::own_options;
using bus::testing::wait_until;

std::vector<TopicSample> take_soon(SessionReader& reader, std::size_t count) {
  std::vector<TopicSample> samples;
  wait_until([&] {
    for (const TopicSample& sample : reader.take_all()) samples.push_back(sample);
    return samples.size() >= count;
  });
  return samples;
}

template <class Message>
void check_heard(const bus::TopicOf<Message>& topic, messages::testing::Random& random) {
  CAPTURE(topic.name);
  const auto options = own_options();
  bus::DdsBus reader_bus(options);
  SessionReader reader(reader_bus);
  bus::DdsBus bus(options);
  auto writer = bus.writer(topic);
  REQUIRE(wait_until([&] { return writer.matched_readers() == 1; }));
  REQUIRE(wait_until([&] { return reader.matched_writers() == 1; }));
  auto message = messages::testing::random_message<Message>(random);
  REQUIRE(writer.write(message));
  const auto samples = take_soon(reader, 1);
  REQUIRE(samples.size() == 1);
  CHECK(samples[0].topic->name == topic.name);
  CHECK(samples[0].payload == cdr_of(message));
}

std::int64_t now_ns() {
  return std::chrono::nanoseconds(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

TEST_CASE("session samples: hears the bytes of every topic") {
  // Oracle: the codec's bytes of the message that was sent.
  messages::testing::Random random(3);
  check_heard(bus::kScene, random);
  check_heard(bus::kSurface, random);
  check_heard(bus::kNodePositions, random);
  check_heard(bus::kProbeInput, random);
  check_heard(bus::kContacts, random);
  check_heard(bus::kModuleStatus, random);
  check_heard(bus::kSessionControl, random);
}

TEST_CASE(
    "session samples: keeps a burst of samples of several keys, in order, with arrival times") {
  // Oracle: what was sent; arrival lies between sending and taking on one monotonic clock. The
  // wall clock that DDS stamps with may be adjusted by some 0.1 ms meanwhile: 5 ms are granted.
  constexpr std::uint32_t kBurst = 200, kProbes = 2;
  constexpr std::int64_t kClockSlackNs = 5'000'000;
  const auto options = own_options();
  bus::DdsBus reader_bus(options);
  SessionReader reader(reader_bus);
  bus::DdsBus bus(options);
  auto writer = bus.writer(bus::kProbeState);
  REQUIRE(
      wait_until([&] { return writer.matched_readers() == 1 && reader.matched_writers() == 1; }));
  const std::int64_t begin_ns = now_ns();
  for (std::uint32_t i = 0; i < kBurst; ++i) {
    ProbeState state = probe_state(0, 0, i % kProbes, {1.0 * i, 0, 0});
    REQUIRE(writer.write(state));
  }
  const auto samples = take_soon(reader, kBurst);
  REQUIRE(samples.size() == kBurst);
  std::set<bus::WriterId> writers;
  for (std::uint32_t i = 0; i < kBurst; ++i) {
    REQUIRE(messages::header_of(samples[i].payload).sequence == i + 1);
    REQUIRE(samples[i].received_time_ns >= begin_ns - kClockSlackNs);
    REQUIRE(samples[i].received_time_ns <= now_ns() + kClockSlackNs);
    writers.insert(samples[i].writer);
  }
  CHECK(writers.size() == 1);
}

TEST_CASE(
    "session samples: the key is found in the bytes: readers keep the newest sample of each key") {
  // Oracle: the bus's own reader, which keeps one sample per key.
  const auto options = own_options();
  bus::DdsBus writer_bus(options);
  SessionWriter writer(writer_bus);
  bus::DdsBus bus(options);
  auto reader = bus.reader(bus::kProbeState);
  const bus::TopicInfo& topic = *bus::find_topic("probe_state");
  REQUIRE(wait_until(
      [&] { return writer.matched_readers(topic) == 1 && reader.matched_writers() == 1; }));
  for (std::uint64_t i = 1; i <= 5; ++i) {
    for (std::uint32_t probe = 0; probe < 3; ++probe) {
      const double x = static_cast<double>(i);
      CHECK(writer.write(topic, cdr_of(probe_state(3 * i + probe, 0, probe, {x, 0, 0}))));
    }
  }
  std::map<std::uint32_t, ProbeState> newest;
  ProbeState state;
  REQUIRE(wait_until([&] {
    while (reader.take(state)) newest[state.probe] = state;
    return newest.size() == 3 && newest[0].pose.position.x() == 5 &&
           newest[1].pose.position.x() == 5 && newest[2].pose.position.x() == 5;
  }));
}

TEST_CASE("session samples: late readers get the newest state of each key") {
  // Oracle: the delivery kind of module_status: newest sample per module, also to late joiners.
  const auto options = own_options();
  bus::DdsBus writer_bus(options);
  SessionWriter writer(writer_bus);
  const bus::TopicInfo& topic = *bus::find_topic("module_status");
  for (std::uint64_t i = 1; i <= 3; ++i) {
    for (const char* module : {"haptics", "collision"}) {
      ModuleStatus status;
      status.header = {i, 0, 1};
      status.module = module;
      CHECK(writer.write(topic, cdr_of(status)));
    }
  }
  bus::DdsBus bus(options);
  auto reader = bus.reader(bus::kModuleStatus);
  std::map<std::string, std::uint64_t> newest;
  ModuleStatus status;
  REQUIRE(wait_until([&] {
    while (reader.take(status)) newest[status.module] = status.header.sequence;
    return newest.size() == 2;
  }));
  CHECK(newest == std::map<std::string, std::uint64_t>{{"collision", 3}, {"haptics", 3}});
  writer.wait_until_received(1);
}

TEST_CASE("session samples: a payload without its encapsulation header is not sent") {
  // Oracle: the rule; CDR begins with four bytes that tell its order.
  bus::DdsBus bus(own_options());
  SessionWriter writer(bus);
  CHECK_FALSE(writer.write(*bus::find_topic("scene"), std::vector<std::uint8_t>{0, 1}));
}

}  // namespace palpate::recording
