// A UDP socket that listens at one address of this host.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

namespace palpate::bus {

/// There are none larger.
inline constexpr std::size_t kMostPacketBytes = 65'536;

class ListeningSocket {
 public:
  /// @param address  of this host, in dotted form
  /// @param room     asked for, for packets that wait [bytes]
  /// @throws std::system_error if there is no listening there, as if the port is taken
  ListeningSocket(const std::string& address, std::uint16_t port, int room);
  ~ListeningSocket();
  ListeningSocket(ListeningSocket&& other) noexcept
      : descriptor_(std::exchange(other.descriptor_, -1)), room_(other.room_) {}
  ListeningSocket(const ListeningSocket&) = delete;
  ListeningSocket& operator=(const ListeningSocket&) = delete;
  ListeningSocket& operator=(ListeningSocket&&) = delete;

  int descriptor() const { return descriptor_; }
  std::size_t room() const { return room_; }  ///< what the kernel gave [bytes]

 private:
  int descriptor_;
  std::size_t room_ = 0;
};

}  // namespace palpate::bus
