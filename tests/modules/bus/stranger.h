// A program on this host, or beside it, that is no participant: a plain UDP socket that overhears
// announcements and sends what it likes.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <set>
#include <string>
#include <utility>

#include "tests/modules/bus/rtps_packets.h"

namespace palpate::bus::testing {

class Stranger {
 public:
  /// Takes the metatraffic port of the last participant that the domain has room for: everybody
  /// announces himself there too.
  explicit Stranger(int domain)
      : Stranger(domain, socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0), "127.0.0.1", "127.0.0.1") {}
  /// @param udp  its socket, perhaps of another network namespace
  /// @param own  address that it hears on
  /// @param to   address that it speaks to
  Stranger(int domain, int udp, const std::string& own, std::string to)
      : first_port_(7400 + 250 * domain), socket_(udp), to_(std::move(to)) {
    REQUIRE(socket_ >= 0);
    const sockaddr_in heard = address(own, first_port_ + 10 + 2 * 90);
    REQUIRE(bind(socket_, generic(heard), sizeof heard) == 0);
  }
  ~Stranger() { close(socket_); }
  Stranger(const Stranger&) = delete;
  Stranger& operator=(const Stranger&) = delete;

  /// The next packet that comes within the time [ms]; empty if none does.
  Bytes hear(int timeout_ms = 2000) {
    pollfd waiting{socket_, POLLIN, 0};
    if (poll(&waiting, 1, timeout_ms) <= 0) return {};
    Bytes packet(65'536);
    const ssize_t size = recv(socket_, packet.data(), packet.size(), 0);
    packet.resize(size < 0 ? 0 : static_cast<std::size_t>(size));
    return packet;
  }

  /// One announcement of each participant that speaks within the time.
  std::vector<Bytes> overhear(int packets) {
    std::set<Bytes> prefixes;
    std::vector<Bytes> announcements;
    for (int k = 0; k < packets; ++k) {
      const Bytes packet = hear();
      if (packet.size() < 20) continue;
      if (prefixes.insert(Bytes(packet.begin() + 8, packet.begin() + 20)).second) {
        announcements.push_back(packet);
      }
    }
    return announcements;
  }

  /// To the multicast port (offset 0) or any other of the domain's ports on this host.
  void send(const Bytes& packet, int port_offset) {
    const sockaddr_in to = address(to_, first_port_ + port_offset);
    sendto(socket_, packet.data(), packet.size(), MSG_DONTWAIT, generic(to), sizeof to);
  }
  /// To the discovery group of every DDS program, by the loopback.
  void send_to_group(const Bytes& packet) {
    const in_addr loopback{htonl(INADDR_LOOPBACK)};
    setsockopt(socket_, IPPROTO_IP, IP_MULTICAST_IF, &loopback, sizeof loopback);
    const sockaddr_in group = address("239.255.0.1", first_port_);
    sendto(socket_, packet.data(), packet.size(), MSG_DONTWAIT, generic(group), sizeof group);
  }

  static constexpr int kFirstOffset = 10, kPorts = 40;  ///< of twenty participants, two each

 private:
  static sockaddr_in address(const std::string& host, int port) {
    sockaddr_in ipv4{};
    ipv4.sin_family = AF_INET;
    ipv4.sin_port = htons(static_cast<std::uint16_t>(port));
    inet_pton(AF_INET, host.c_str(), &ipv4.sin_addr);
    return ipv4;
  }
  static const sockaddr* generic(const sockaddr_in& ipv4) {
    const void* const any = &ipv4;
    return static_cast<const sockaddr*>(any);
  }

  int first_port_;
  int socket_;
  std::string to_;
};

}  // namespace palpate::bus::testing
