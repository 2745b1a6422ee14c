// What an RTPS packet is made of (OMG RTPS 2.3, 9.4): a header, and sub-messages that have headers
// of their own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "modules/bus/byte_cursor.h"

namespace palpate::bus {

inline constexpr std::size_t kRtpsHeaderBytes = 20, kSubmessageHeaderBytes = 4;
inline constexpr std::size_t kPrefixAt = 8;  ///< of the participant's prefix in the header

enum SubmessageKind : std::uint8_t {
  kPad = 0x01,
  kAckNack = 0x06,
  kHeartbeat = 0x07,
  kGap = 0x08,
  kInfoTimestamp = 0x09,
  kInfoReplyIp4 = 0x0d,
  kInfoDestination = 0x0e,
  kInfoReply = 0x0f,
  kNackFrag = 0x12,
  kHeartbeatFrag = 0x13,
  kData = 0x15,
  kDataFrag = 0x16,
};

enum SubmessageFlag : std::uint8_t {
  kLittleEndian = 1,
  kSecondFlag = 2,  ///< inline QoS in data; no time in INFO_TS; a second locator in replies
  kPayloadFlag = 4,
  kKeyFlag = 8,
};

/// The bytes that the sub-message takes with which `rest` begins; none if it ends beyond that.
inline std::optional<std::size_t> submessage_size(std::span<const std::uint8_t> rest) {
  if (rest.size() < kSubmessageHeaderBytes) return {};
  const bool little = (rest[1] & kLittleEndian) != 0;
  const std::size_t length = Cursor(rest.subspan(2, 2), little).two();
  const bool to_the_end = length == 0 && rest[0] != kPad && rest[0] != kInfoTimestamp;
  const std::size_t size = to_the_end ? rest.size() : kSubmessageHeaderBytes + length;
  if (size > rest.size()) return {};
  return size;
}

}  // namespace palpate::bus
