#include "modules/bus/packet_gatherer.h"

#include <unistd.h>

#include <atomic>
#include <catch2/catch.hpp>
#include <chrono>
#include <cstring>
#include <system_error>

#include "tests/modules/bus/loopback_socket.h"
#include "tests/modules/waiting.h"

namespace palpate::bus {
namespace {

using palpate::testing::wait_until;
using testing::free_port;
using testing::LoopbackSocket;

constexpr int kRoom = 1 << 20;
constexpr std::int64_t kBetweenClocksNs = 100'000;  // two clocks are read one after the other

template <class Clock>
std::int64_t clock_ns() {
  return std::chrono::nanoseconds(Clock::now().time_since_epoch()).count();
}

struct GatheredPacket {
  std::uint32_t number = 0;
  std::size_t bytes = 0;
  std::uint16_t from = 0;
  std::int64_t arrived_ns = 0;
};

/// What a gatherer hands over, in its order.
class Ear {
 public:
  explicit Ear(std::uint16_t port)
      : gatherer_({"127.0.0.1"}, port, kRoom, [this](const ArrivedPacket& packet) {
          GatheredPacket heard{0, packet.bytes.size(), packet.sender.port, packet.arrived_ns};
          std::memcpy(&heard.number, packet.bytes.data(), sizeof heard.number);
          const std::lock_guard lock(mutex_);
          heard_.push_back(heard);
        }) {}
  std::vector<GatheredPacket> heard() const {
    const std::lock_guard lock(mutex_);
    return heard_;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<GatheredPacket> heard_;
  PacketGatherer gatherer_;
};

}  // namespace

TEST_CASE("gatherer: every packet comes once, whole, in order, with its sender and arrival",
          "[bus]") {
  // Oracle: the numbers and sizes sent, up to the largest there are, and the clock before each call
  // that sends. A packet is in the socket of the loopback when that returns, on a busy machine a
  // moment later; it is read up to kLongest later. By the time of reading one in forty would do.
  const std::uint16_t port = free_port();
  const Ear ear(port);
  const LoopbackSocket sender;
  usleep(100'000);  // until the kernel stamps: it begins a moment after it was asked to
  std::vector<std::int64_t> before;
  constexpr std::uint32_t kCount = 200;
  for (std::uint32_t k = 0; k < kCount; ++k) {
    before.push_back(clock_ns<std::chrono::steady_clock>());
    sender.send(port, k, k % 50 == 0 ? 65'507 : 4 + k);
    usleep(500);
  }
  REQUIRE(wait_until([&] { return ear.heard().size() >= kCount; }));
  const std::vector<GatheredPacket> heard = ear.heard();
  REQUIRE(heard.size() == kCount);
  std::uint32_t stamped = 0;
  for (std::uint32_t k = 0; k < kCount; ++k) {
    CHECK(heard[k].number == k);
    CHECK(heard[k].bytes == (k % 50 == 0 ? 65'507 : 4 + k));
    CHECK(heard[k].from == sender.port());
    CHECK(heard[k].arrived_ns >= before[k] - kBetweenClocksNs);
    stamped += k + 1 < kCount && heard[k].arrived_ns < before[k + 1];
  }
  CHECK(stamped > kCount / 2);
}

TEST_CASE("gatherer: what waited long in the socket bears the time of its arrival, too", "[bus]") {
  // Oracle: the clock when it was sent, and half a second for which the gatherer's thread is held.
  // By its wall clock's time of reading, as if that had been set, it would be that later.
  const std::uint16_t port = free_port();
  std::mutex mutex;
  std::vector<ArrivedPacket> heard;
  std::atomic<bool> held{false};
  const PacketGatherer gatherer({"127.0.0.1"}, port, kRoom, [&](const ArrivedPacket& packet) {
    const std::lock_guard lock(mutex);
    heard.push_back(packet);
    held = true;
    usleep(packet.bytes[0] == 1 ? 500'000 : 0);
  });
  usleep(100'000);  // until the kernel stamps
  const LoopbackSocket sender;
  sender.send(port, 1, 8);
  REQUIRE(wait_until([&] { return held.load(); }));
  const std::int64_t before = clock_ns<std::chrono::steady_clock>();
  sender.send(port, 2, 8);
  const std::int64_t after = clock_ns<std::chrono::steady_clock>();
  REQUIRE(wait_until([&] {
    const std::lock_guard lock(mutex);
    return heard.size() == 2;
  }));
  CHECK(heard[1].arrived_ns > before - kBetweenClocksNs);
  CHECK(heard[1].arrived_ns < after + 250'000'000);
  const std::int64_t shift =
      clock_ns<std::chrono::system_clock>() - clock_ns<std::chrono::steady_clock>();
  CHECK(std::abs(heard[1].by_wall_ns - heard[1].arrived_ns - shift) < 10'000'000);
}

TEST_CASE("gatherer: a port that is taken, and an address of nobody here, are told", "[bus]") {
  // Oracle: a socket of the test's own; an address kept for documents (RFC 5737).
  const LoopbackSocket taken;
  const auto ignore = [](const ArrivedPacket&) {};
  CHECK_THROWS_AS(PacketGatherer({"127.0.0.1"}, taken.port(), kRoom, ignore), std::system_error);
  CHECK_THROWS_AS(PacketGatherer({"192.0.2.1"}, free_port(), kRoom, ignore), std::system_error);
}

TEST_CASE("gatherer: it ends while packets rain", "[bus]") {
  // Oracle: the destructor returns, within the deadline of all tests.
  const std::uint16_t port = free_port();
  std::atomic<bool> raining{true};
  std::atomic<int> heard{0};
  std::thread rain([&] {
    const LoopbackSocket sender;
    while (raining) sender.send(port, 0, 64);
  });
  {
    const PacketGatherer gatherer({"127.0.0.1"}, port, kRoom,
                                  [&](const ArrivedPacket&) { ++heard; });
    CHECK(wait_until([&] { return heard > 1000; }));
  }
  raining = false;
  rain.join();
}

TEST_CASE("gatherer: packets wait for the longest pause where they have room, and no longer",
          "[bus]") {
  // Oracle: by hand: a quarter of the room is never passed twice at the same pause.
  GatheringPause pause;
  for (int k = 0; k < 20; ++k) pause.note(0, 1000);
  CHECK(pause.seconds() == GatheringPause::kLongest);
  pause.note(200, 1000);  // enough to stay, too little to shorten
  CHECK(pause.seconds() == GatheringPause::kLongest);
  pause.note(251, 1000);
  CHECK(pause.seconds() == GatheringPause::kLongest / 2);
  for (int k = 0; k < 20; ++k) pause.note(1000, 1000);
  CHECK(pause.seconds() == GatheringPause::kShortest);
}

}  // namespace palpate::bus
