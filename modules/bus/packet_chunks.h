// Packets too large for a network's, in chunks that are not, with parity: one lost of four is made
// up.
//
// A datagram of 60 KB would travel in forty fragments of IP, of which none may be lost; and the
// kernel gives up those that overtake others (ipfrag_max_dist): after a few thousand on a link of
// 20 ± 10 ms nothing larger than a packet came through any more. Repeats on demand come a round
// trip late and hold up what is newer: of a stream the next sample is worth more than the last.
//
// A chunk: 16 bytes (the magic word, the packet's number, the chunk's index, how many hold data,
// how many bytes the packet has), data, 64 bytes of zeros. Chunk i of n belongs to group i mod
// ⌈n/3⌉, so that neighbours are in different ones; behind the n come as many parities as there are
// groups, each the bytewise sum (exclusive or) of its group.
#pragma once

#include <array>
#include <cstdint>
#include <mutex>
#include <span>
#include <vector>

#include "modules/bus/packet_senders.h"

namespace palpate::bus {

/// Bytes of a datagram without the headers of IP and UDP: they leave room for a tunnel's in an
/// Ethernet packet.
inline constexpr std::size_t kChunkBytes = 1'400;

/// No RTPS packet is one: those begin with "RTPS".
bool is_chunk(std::span<const std::uint8_t> datagram);

/// What is to be sent in the place of a packet.
class PacketChunks {
 public:
  /// @param packet  longer than kChunkBytes, at most 64 KiB  @param number  of it, by this sender
  PacketChunks(std::span<const std::uint8_t> packet, std::uint32_t number);
  std::size_t count() const { return sizes_.size(); }  ///< data and parities
  std::span<const std::uint8_t> at(std::size_t index) const {
    return {bytes_.data() + index * kChunkBytes, sizes_[index]};
  }

 private:
  std::vector<std::uint8_t> bytes_;  ///< kChunkBytes for each
  std::vector<std::size_t> sizes_;
};

/// Puts packets together again, those of kMostOpen senders and numbers at a time: what is never
/// whole makes room. Thread-safe.
class ChunkAssembler {
 public:
  /// True if the packet is whole with this chunk, once: then `packet` is it.
  bool add(std::span<const std::uint8_t> chunk, const PacketSender& sender,
           std::vector<std::uint8_t>& packet);

  static constexpr std::size_t kMostOpen = 64;

 private:
  struct Open {
    PacketSender sender;
    std::uint32_t number = 0;
    std::uint64_t age = 0;
    bool done = false;
    std::size_t total = 0, missing = 0;
    std::vector<bool> has;            ///< of data and parities
    std::vector<std::uint8_t> bytes;  ///< of both, each as long as a chunk's data
  };
  Open& open(const PacketSender& sender, std::uint32_t number, std::size_t data, std::size_t total);
  static void make_up(Open& packet, std::size_t group);

  std::mutex mutex_;
  std::array<Open, kMostOpen> open_;
  std::uint64_t age_ = 0;
};

}  // namespace palpate::bus
