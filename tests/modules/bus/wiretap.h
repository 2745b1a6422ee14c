// Overhears a domain on the loopback, and forges: sends what it likes in a participant's name and
// from its very address and port. Needs root (raw sockets).
#pragma once

#include <arpa/inet.h>
#include <linux/if_ether.h>
#include <linux/if_packet.h>
#include <net/if.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <stdexcept>
#include <string>

#include "tests/modules/bus/rtps_packets.h"

namespace palpate::bus::testing {

/// Between participants of a domain on this host.
struct OverheardPacket {
  std::uint16_t from_port = 0, to_port = 0;
  Bytes bytes;
};

class Wiretap {
 public:
  /// Why nobody can listen here; empty if one can.
  static std::string impossible() { return geteuid() == 0 ? "" : "raw sockets need root"; }

  explicit Wiretap(int domain) : first_port_(7400 + 250 * domain) {
    constexpr int kBuffer = 8 << 20;
    setsockopt(tap_, SOL_SOCKET, SO_RCVBUFFORCE, &kBuffer, sizeof kBuffer);
    sockaddr_ll loopback{};
    loopback.sll_family = AF_PACKET;
    loopback.sll_protocol = htons(ETH_P_IP);
    loopback.sll_ifindex = static_cast<int>(if_nametoindex("lo"));
    const void* const any = &loopback;
    const auto* const generic = static_cast<const sockaddr*>(any);
    if (bind(tap_, generic, sizeof loopback) != 0 || forge_ < 0)
      throw std::runtime_error("no raw sockets");
  }
  ~Wiretap() {
    close(tap_);
    close(forge_);
  }
  Wiretap(const Wiretap&) = delete;
  Wiretap& operator=(const Wiretap&) = delete;

  /// What came since the last time, the forged among it.
  std::vector<OverheardPacket> overheard() {
    std::vector<OverheardPacket> packets;
    Bytes bytes(65'536);
    sockaddr_ll how{};
    socklen_t size_of_how = sizeof how;
    void* const any = &how;
    for (ssize_t size; (size = recvfrom(tap_, bytes.data(), bytes.size(), MSG_DONTWAIT,
                                        static_cast<sockaddr*>(any), &size_of_how)) > 0;) {
      const std::size_t udp = 4u * (bytes[0] & 0x0f);          // behind the IP header
      const bool leaves = how.sll_pkttype == PACKET_OUTGOING;  // each is seen twice on a loopback
      if (leaves || bytes[9] != IPPROTO_UDP || std::size_t(size) < udp + kUdpHeader) continue;
      const auto port = [&](std::size_t at) {
        return std::uint16_t(bytes[at] << 8 | bytes[at + 1]);
      };
      const int to = port(udp + 2);
      if (to < first_port_ || to >= first_port_ + 250) continue;
      packets.push_back(
          {port(udp), port(udp + 2),
           Bytes(bytes.begin() + std::ptrdiff_t(udp + kUdpHeader), bytes.begin() + size)});
    }
    return packets;
  }

  /// From 127.0.0.1 and the port that the packet names.
  void forge(const OverheardPacket& packet) {
    const auto high = [](std::size_t value) { return std::uint8_t(value >> 8); };
    const auto low = [](std::size_t value) { return std::uint8_t(value); };
    const std::size_t length = kUdpHeader + packet.bytes.size();
    // The kernel fills in length and sum of the IP header; a UDP sum of 0 is none.
    Bytes ip{0x45,
             0,
             0,
             0,
             0,
             0,
             0,
             0,
             64,
             IPPROTO_UDP,
             0,
             0,
             127,
             0,
             0,
             1,
             127,
             0,
             0,
             1,
             high(packet.from_port),
             low(packet.from_port),
             high(packet.to_port),
             low(packet.to_port),
             high(length),
             low(length),
             0,
             0};
    ip.insert(ip.end(), packet.bytes.begin(), packet.bytes.end());
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const void* const any = &to;
    sendto(forge_, ip.data(), ip.size(), 0, static_cast<const sockaddr*>(any), sizeof to);
  }

 private:
  static constexpr std::size_t kUdpHeader = 8;

  int first_port_;
  int tap_ = socket(AF_PACKET, SOCK_DGRAM | SOCK_CLOEXEC, htons(ETH_P_IP));
  int forge_ = socket(AF_INET, SOCK_RAW | SOCK_CLOEXEC, IPPROTO_RAW);
};

}  // namespace palpate::bus::testing
