#include "modules/bus/polled_sockets.h"

#include <sys/socket.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <chrono>
#include <system_error>
#include <thread>

#include "tests/modules/bus/loopback_socket.h"

namespace palpate::bus {
namespace {

using testing::free_port;
using testing::LoopbackSocket;

constexpr int kPolledRoom = 1 << 20;
const std::vector<std::string> kLoopback{"127.0.0.1"};

struct PolledPacket {
  std::uint32_t number = 0;
  std::size_t bytes = 0;
  std::uint16_t from = 0;
};

/// What sockets hand over, in their order.
struct PolledEar {
  PolledEar() = default;
  explicit PolledEar(std::uint16_t port) { open(port); }
  void open(std::uint16_t port) {
    sockets.open(kLoopback, port, kPolledRoom,
                 [this](std::span<const std::uint8_t> packet, const PacketSender& sender) {
                   PolledPacket each{0, packet.size(), sender.port};
                   std::memcpy(&each.number, packet.data(), sizeof each.number);
                   heard.push_back(each);
                 });
  }
  PolledSockets sockets;
  std::vector<PolledPacket> heard;
};

double seconds_taken(const std::function<void()>& work) {
  const auto began = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
}

}  // namespace

TEST_CASE("polled sockets: all that came is heard at once, whole, in order, with its sender",
          "[bus]") {
  // Oracle: the numbers and sizes sent, up to the largest there are, by two senders in turns.
  const std::uint16_t port = free_port();
  PolledEar ear(port);
  const LoopbackSocket senders[2];
  CHECK_FALSE(ear.sockets.hear(0));
  for (std::uint32_t k = 0; k < 20; ++k) senders[k % 2].send(port, k, k == 7 ? 65'507 : 4 + k);
  CHECK(ear.sockets.hear(0));
  REQUIRE(ear.heard.size() == 20);
  for (std::uint32_t k = 0; k < 20; ++k) {
    CHECK(ear.heard[k].number == k);
    CHECK(ear.heard[k].bytes == (k == 7 ? 65'507 : 4 + k));
    CHECK(ear.heard[k].from == senders[k % 2].port());
  }
  CHECK_FALSE(ear.sockets.hear(0));
}

TEST_CASE("polled sockets: who waits is woken by what comes, on any of them, or when time is up",
          "[bus]") {
  // Oracle: the clock: a packet after 20 ms of a wait of 10 s, by the second of two ports; none in
  // a wait of 30 ms.
  PolledEar ear(free_port());
  const std::uint16_t port = free_port();
  ear.open(port);
  std::thread later;
  const double woken = seconds_taken([&] {
    later = std::thread([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      LoopbackSocket().send(port, 5, 8);
    });
    CHECK(ear.sockets.hear(10));
  });
  later.join();
  CHECK(woken >= 0.02);
  CHECK(woken < 9);
  REQUIRE(ear.heard.size() == 1);
  CHECK(ear.heard[0].number == 5);
  CHECK(seconds_taken([&] { CHECK_FALSE(ear.sockets.hear(0.03)); }) >= 0.03);
}

TEST_CASE("polled sockets: a port is open until it is closed, and one that is taken is told",
          "[bus]") {
  // Oracle: a socket of the test's own takes the port before and after.
  const std::uint16_t port = free_port();
  PolledEar ear;
  {
    const LoopbackSocket taken;
    CHECK_THROWS_AS(ear.open(taken.port()), std::system_error);
    CHECK_FALSE(ear.sockets.is_open(taken.port()));
  }
  ear.open(port);
  CHECK(ear.sockets.is_open(port));
  CHECK_THROWS_AS(ear.open(port), std::system_error);
  CHECK(ear.sockets.close(port));
  CHECK_FALSE(ear.sockets.is_open(port));
  CHECK_FALSE(ear.sockets.close(port));
  ear.open(port);
  LoopbackSocket().send(port, 1, 4);
  CHECK(ear.sockets.hear(1));
}

TEST_CASE("polled sockets: hearing ends while packets rain", "[bus]") {
  // Oracle: hear() returns, with no more than it may take at once.
  const std::uint16_t port = free_port();
  PolledEar ear(port);
  std::atomic<bool> raining{true};
  std::thread rain([&] {
    const LoopbackSocket sender;
    while (raining) sender.send(port, 0, 64);
  });
  for (int k = 0; k < 20; ++k) {
    const std::size_t before = ear.heard.size();
    CHECK(ear.sockets.hear(5));
    CHECK(ear.heard.size() - before <= PolledSockets::kMostAtOnce);
  }
  raining = false;
  rain.join();
}

TEST_CASE("polled sockets: what is watched is served when something came, or there is room",
          "[bus]") {
  // Oracle: a pair of sockets of the test's own.
  int pair[2];
  REQUIRE(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, pair) == 0);
  PolledSockets sockets;
  int served = 0;
  sockets.watch(pair[0], [&] {
    ++served;
    char byte = 0;
    return ::recv(pair[0], &byte, 1, 0) == 1;
  });
  CHECK_FALSE(sockets.hear(0));
  REQUIRE(::send(pair[1], "a", 1, 0) == 1);
  CHECK(sockets.hear(1));
  CHECK(served == 1);
  sockets.await_room(pair[0], true);
  CHECK_FALSE(sockets.hear(1));  // there is room, and nothing came
  CHECK(served == 2);
  sockets.await_room(pair[0], false);
  CHECK_FALSE(sockets.hear(0));
  CHECK(served == 2);
  sockets.forget(pair[0]);
  REQUIRE(::send(pair[1], "a", 1, 0) == 1);
  CHECK_FALSE(sockets.hear(0));
  CHECK(served == 2);
  for (const int each : pair) ::close(each);
}

TEST_CASE("polled sockets: who is served may end itself and another one", "[bus]") {
  // Oracle: of two that have something, whoever is served first leaves the other unserved.
  int first[2], second[2];
  for (int* pair : {first, second}) {
    REQUIRE(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, pair) == 0);
    REQUIRE(::send(pair[1], "a", 1, 0) == 1);
  }
  PolledSockets sockets;
  int served = 0;
  const auto end_both = [&] {
    ++served;
    sockets.forget(first[0]);
    sockets.forget(second[0]);
    return true;
  };
  sockets.watch(first[0], end_both);
  sockets.watch(second[0], end_both);
  CHECK(sockets.hear(1));
  CHECK(served == 1);
  CHECK_FALSE(sockets.hear(0));
  CHECK_THROWS_AS(sockets.watch(-1, end_both), std::system_error);
  for (const int* pair : {first, second}) {
    ::close(pair[0]);
    ::close(pair[1]);
  }
}

}  // namespace palpate::bus
