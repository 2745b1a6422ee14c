// Hears packets in the thread that waits for them. Where a process has nothing to do until a packet
// comes, a thread of its own for hearing is woken first, and wakes it then: on the way from process
// to process that was half of the time.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "modules/bus/listening_socket.h"
#include "modules/bus/packet_senders.h"

namespace palpate::bus {

/// Sockets that nobody reads but hear(): meanwhile packets wait in them, as far as there is room.
/// All calls come from one thread.
class PolledSockets {
 public:
  using Take = std::function<void(std::span<const std::uint8_t>, const PacketSender&)>;
  /// Reads a descriptor, or writes to it. @returns whether anything was taken
  using Serve = std::function<bool()>;
  /// Of one socket in one hear(), so that it ends while packets rain.
  static constexpr int kMostAtOnce = 4096;

  /// @throws std::system_error if the system has no descriptor left
  PolledSockets();
  ~PolledSockets();
  PolledSockets(const PolledSockets&) = delete;
  PolledSockets& operator=(const PolledSockets&) = delete;

  /// @param addresses  of this host, in dotted form
  /// @param room       of each socket, asked for [bytes]
  /// @param take       called by hear()
  /// @throws std::system_error as ListeningSocket does, or if the system takes no more; then it
  ///                  listens at none of them
  void open(const std::vector<std::string>& addresses, std::uint16_t port, int room,
            const Take& take);
  bool is_open(std::uint16_t port) const;
  bool close(std::uint16_t port);  ///< false if it is not open

  /// Of another kind: `serve` is called by hear() when something has come, or room is awaited and
  /// there. It may watch and forget descriptors, its own too.
  /// @throws std::system_error if the system takes no more
  void watch(int descriptor, Serve serve);
  void await_room(int descriptor, bool awaited);  ///< of a watched one
  void forget(int descriptor);                    ///< before it is closed

  /// Takes what has come; if nothing has, waits until something comes, at most `longest` [s], to
  /// the next millisecond.
  /// @return whether anything was taken
  bool hear(double longest);

 private:
  static constexpr int kMostReady = 64;  ///< in one call of the system
  bool drain(int descriptor, const Take& take);

  std::map<std::uint16_t, std::vector<ListeningSocket>> channels_;  ///< by port
  std::map<int, std::shared_ptr<Serve>> served_;                    ///< by descriptor
  int ready_;  ///< tells which of them have something
  /// Memory for a packet; touched as far as packets are long.
  std::unique_ptr<std::uint8_t[]> packet_ =
      std::make_unique_for_overwrite<std::uint8_t[]>(kMostPacketBytes);
};

}  // namespace palpate::bus
