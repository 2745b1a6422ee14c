#include "modules/bus/packet_stamp.h"

#include <cstddef>

namespace palpate::bus {
namespace {

constexpr std::size_t kRtpsHeaderBytes = 20, kSubmessageHeaderBytes = 4, kTimeBytes = 8;
constexpr std::uint8_t kPad = 0x01, kInfoTimestamp = 0x09;
constexpr std::uint8_t kLittleEndian = 1, kNoTime = 2;
constexpr std::int64_t kSecondNs = 1'000'000'000;

void put(std::uint32_t number, bool little, std::span<std::uint8_t> into) {
  for (std::size_t i = 0; i < 4; ++i) {
    into[little ? i : 3 - i] = static_cast<std::uint8_t>(number >> 8 * i);
  }
}

}  // namespace

void stamp_arrival(std::span<std::uint8_t> packet, std::int64_t arrived_ns) {
  const auto seconds = static_cast<std::uint32_t>(arrived_ns / kSecondNs);
  const auto part = static_cast<std::uint64_t>(arrived_ns % kSecondNs);
  // Rounded up: who makes nanoseconds of it again cuts.
  const auto fraction = static_cast<std::uint32_t>(((part << 32) + kSecondNs - 1) / kSecondNs);
  std::size_t at = kRtpsHeaderBytes;
  while (at + kSubmessageHeaderBytes <= packet.size()) {
    const std::uint8_t kind = packet[at], flags = packet[at + 1];
    const bool little = (flags & kLittleEndian) != 0;
    const std::size_t length =
        little ? packet[at + 2] | packet[at + 3] << 8 : packet[at + 2] << 8 | packet[at + 3];
    at += kSubmessageHeaderBytes;
    if (length > packet.size() - at) return;
    if (length == 0 && kind != kPad && kind != kInfoTimestamp) return;  // to the packet's end
    if (kind == kInfoTimestamp && (flags & kNoTime) == 0 && length >= kTimeBytes) {
      put(seconds, little, packet.subspan(at, 4));
      put(fraction, little, packet.subspan(at + 4, 4));
    }
    at += length;
  }
}

}  // namespace palpate::bus
