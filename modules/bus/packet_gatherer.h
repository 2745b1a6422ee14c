// Hears the packets of a port as who needs every one of them, and none at once: they wait in the
// socket and are taken many at a time. A thread that is woken for each packet, as that of the DDS
// library, spends more on being woken than on what came.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "modules/bus/listening_socket.h"
#include "modules/bus/packet_senders.h"
#include "modules/bus/wall_clock_shift.h"

namespace palpate::bus {

struct ArrivedPacket {
  std::span<std::uint8_t> bytes;
  PacketSender sender;
  std::int64_t arrived_ns = 0;  ///< when the kernel had it, by the monotonic clock
  std::int64_t by_wall_ns = 0;  ///< the same, by the wall clock of now
};

/// How long packets may wait [s]: shorter where a socket's room would not do. What came is told
/// after each taking.
class GatheringPause {
 public:
  static constexpr double kLongest = 0.02, kShortest = 0.00025;

  /// @param waited, room  bytes that waited in a socket, and that may
  void note(std::size_t waited, std::size_t room);
  double seconds() const { return seconds_; }

 private:
  double seconds_ = 0.001;
};

class PacketGatherer {
 public:
  using Take = std::function<void(const ArrivedPacket&)>;

  /// @param addresses  of this host, in dotted form
  /// @param room       of each socket, asked for [bytes]
  /// @param take       called by a thread of this one
  /// @throws std::system_error if there is no listening at one of them, as if the port is taken
  PacketGatherer(const std::vector<std::string>& addresses, std::uint16_t port, int room,
                 Take take);
  ~PacketGatherer();
  PacketGatherer(const PacketGatherer&) = delete;
  PacketGatherer& operator=(const PacketGatherer&) = delete;

 private:
  struct Socket {
    ListeningSocket listening;
    WallClockShift shift;  ///< the kernel stamps with the wall clock
  };
  class Batch;

  void run();
  std::size_t drain(Socket& socket, Batch& batch) const;

  Take take_;
  std::vector<Socket> sockets_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace palpate::bus
