// Sends datagrams on the loopback.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <cstdint>
#include <cstring>
#include <vector>

namespace palpate::bus::testing {

/// A socket of the loopback with a free port.
class LoopbackSocket {
 public:
  LoopbackSocket() : descriptor_(::socket(AF_INET, SOCK_DGRAM, 0)) {
    sockaddr_in any = at(0);
    REQUIRE(::bind(descriptor_, reinterpret_cast<sockaddr*>(&any), sizeof any) == 0);
    socklen_t size = sizeof any;
    REQUIRE(::getsockname(descriptor_, reinterpret_cast<sockaddr*>(&any), &size) == 0);
    port_ = ntohs(any.sin_port);
  }
  ~LoopbackSocket() { close(); }
  void close() {
    if (descriptor_ >= 0) ::close(descriptor_);
    descriptor_ = -1;
  }
  std::uint16_t port() const { return port_; }
  void send(std::uint16_t to, std::uint32_t number, std::size_t bytes) const {
    std::vector<std::uint8_t> packet(bytes);
    std::memcpy(packet.data(), &number, sizeof number);
    const sockaddr_in there = at(to);
    ::sendto(descriptor_, packet.data(), bytes, 0, reinterpret_cast<const sockaddr*>(&there),
             sizeof there);
  }

 private:
  static sockaddr_in at(std::uint16_t port) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    return address;
  }
  int descriptor_;
  std::uint16_t port_ = 0;
};

/// Free a moment ago, and above all where sessions of other tests look for each other: a stranger's
/// packet is one too many.
inline std::uint16_t free_port() {
  constexpr std::uint16_t kLastOfDomains = 7400 + 250 * 200 + 250;  // RTPS 2.5, 9.6.2.4
  constexpr int kTries = 1000;  // where the kernel gives such ports, one in nine is
  for (int k = 0; k < kTries; ++k) {
    const LoopbackSocket free;
    if (free.port() > kLastOfDomains) return free.port();
  }
  return LoopbackSocket().port();
}

}  // namespace palpate::bus::testing
