#include "modules/bus/packet_stamp.h"

#include <algorithm>
#include <cstddef>

#include "modules/bus/rtps_words.h"
#include "modules/core/units.h"

namespace palpate::bus {
namespace {

constexpr std::size_t kTimeBytes = 8;

void put(std::uint32_t number, bool little, std::span<std::uint8_t> into) {
  for (std::size_t i = 0; i < 4; ++i) {
    into[little ? i : 3 - i] = static_cast<std::uint8_t>(number >> 8 * i);
  }
}

}  // namespace

void stamp_arrival(std::span<std::uint8_t> packet, std::int64_t arrived_ns) {
  const auto seconds = static_cast<std::uint32_t>(arrived_ns / kNanosecondsPerSecond);
  const auto part = static_cast<std::uint64_t>(arrived_ns % kNanosecondsPerSecond);
  // Rounded up: who makes nanoseconds of it again cuts.
  const auto fraction = static_cast<std::uint32_t>(((part << 32) + kNanosecondsPerSecond - 1) /
                                                   kNanosecondsPerSecond);
  for (auto rest = packet.subspan(std::min(kRtpsHeaderBytes, packet.size())); !rest.empty();) {
    const auto size = submessage_size(rest);
    if (!size) return;
    const std::uint8_t kind = rest[0], flags = rest[1];
    if (kind == kInfoTimestamp && (flags & kSecondFlag) == 0 &&
        *size >= kSubmessageHeaderBytes + kTimeBytes) {
      const bool little = (flags & kLittleEndian) != 0;
      put(seconds, little, rest.subspan(kSubmessageHeaderBytes, 4));
      put(fraction, little, rest.subspan(kSubmessageHeaderBytes + 4, 4));
    }
    rest = rest.subspan(*size);
  }
}

}  // namespace palpate::bus
