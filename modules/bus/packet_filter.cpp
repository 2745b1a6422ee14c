#include "modules/bus/packet_filter.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>

#include "modules/bus/authentication_words.h"
#include "modules/bus/byte_cursor.h"
#include "modules/bus/rtps_words.h"
#include "modules/bus/secured_words.h"
#include "modules/messages/message_types.h"

namespace palpate::bus {
namespace {

using Octets = std::span<const std::uint8_t>;

constexpr std::size_t kGuidPrefixBytes = 12;
constexpr std::array<std::uint8_t, 5> kRtpsMagic{'R', 'T', 'P', 'S', 2};
constexpr std::uint8_t kFirstVendorKind = 0x80;
constexpr std::uint32_t kMaxSetBits = 256;  // of sequence and fragment numbers, by the standard
constexpr std::size_t kLocatorBytes = 24;

struct Submessage {
  std::uint8_t kind = 0, flags = 0;
  Octets content;
  Octets owner;  ///< prefix of the packet's participant
  const SampleRules& rules;
  bool has(SubmessageFlag flag) const { return (flags & flag) != 0; }
  Cursor cursor() const { return {content, has(kLittleEndian)}; }
};

PacketFault checked(const Cursor& cursor) {
  return cursor.missing() ? PacketFault::kLength : PacketFault::kNone;
}

// Bits after their base: the bound of the set, and its words.
bool set_fits(Cursor& cursor) {
  const std::uint32_t bits = cursor.four();
  cursor.skip((bits + 31) / 32 * 4);
  return bits <= kMaxSetBits;
}

// What a parameter list may say of its owner; a user's list has none.
using Owner = Octets;  // 12 bytes, or none

bool is_guid(std::uint16_t parameter) {
  return parameter == 0x50 || parameter == 0x5a || parameter == 0x70;  // participant, endpoint, key
}

bool owned(std::uint16_t parameter, Octets value, Owner owner) {
  return !is_guid(parameter) || owner.empty() ||
         std::equal(owner.begin(), owner.end(), value.begin());
}

bool length_fits(std::uint16_t parameter, std::size_t length) {
  constexpr std::uint16_t kStatusInfo = 0x71;
  if (parameter == kStatusInfo) return length == 4;
  return is_guid(parameter) ? length == 16 : length % 4 == 0;
}

// Moves the cursor behind the list.
PacketFault check_parameters(Cursor& cursor, Owner owner) {
  constexpr std::uint16_t kSentinel = 1;
  while (!cursor.left().empty()) {
    const std::uint16_t id = cursor.two(), length = cursor.two();
    if (id == kSentinel) return checked(cursor);
    if (!length_fits(id, length) || length > cursor.left().size()) return PacketFault::kParameters;
    if (!owned(id, cursor.left().first(length), owner)) return PacketFault::kIdentity;
    cursor.skip(length);
  }
  return PacketFault::kParameters;
}

bool built_in(std::uint32_t writer) { return (writer & 0xc0) == 0xc0; }

bool carries_parameters(std::uint32_t writer) {
  switch (writer) {
    case 0x000100c2:  // SPDP: participants
    case 0x000002c2:  // SEDP: topics, writers, readers
    case 0x000003c2:
    case 0x000004c2:
      return true;
    default:
      return false;
  }
}

PacketFault check_payload(const Submessage& message, std::uint32_t writer, Octets payload) {
  if (!message.has(kPayloadFlag) && !message.has(kKeyFlag)) return PacketFault::kNone;
  if (payload.size() < 4) return PacketFault::kLength;  // encapsulation
  if (!built_in(writer) && message.has(kPayloadFlag) &&
      messages::token_of(payload) != message.rules.token) {
    return PacketFault::kToken;
  }
  if (writer == kAuthenticationWriter) {
    return is_generic_message(payload) ? PacketFault::kNone : PacketFault::kParameters;
  }
  if (!carries_parameters(writer)) return PacketFault::kNone;
  const std::uint8_t encapsulation = payload[1];
  if (payload[0] != 0 || (encapsulation != 2 && encapsulation != 3)) {
    return PacketFault::kParameters;
  }
  Cursor parameters(payload.subspan(4), encapsulation == 3);
  return check_parameters(parameters, message.owner);
}

PacketFault check_data(const Submessage& message) {
  constexpr std::uint16_t kToInlineQos = 16;  // at least: what lies between may grow
  Cursor cursor = message.cursor();
  cursor.skip(2);  // extra flags
  const std::uint16_t to_qos = cursor.two();
  cursor.entity();
  const std::uint32_t writer = cursor.entity();
  const std::int64_t sequence = cursor.sequence();
  if (to_qos < kToInlineQos) return PacketFault::kLength;
  cursor.skip(to_qos - kToInlineQos);
  if (cursor.missing()) return PacketFault::kLength;
  if (sequence <= 0) return PacketFault::kSequence;
  if (message.has(kSecondFlag)) {
    const PacketFault fault = check_parameters(cursor, built_in(writer) ? message.owner : Owner());
    if (fault != PacketFault::kNone) return fault;
  }
  return check_payload(message, writer, cursor.left());
}

PacketFault check_data_frag(const Submessage& message) {
  constexpr std::uint16_t kToInlineQos = 28;
  Cursor cursor = message.cursor();
  cursor.skip(2);
  const std::uint16_t to_qos = cursor.two();
  cursor.entity();
  const std::uint32_t writer = cursor.entity();
  const std::int64_t sequence = cursor.sequence();
  const std::uint64_t first = cursor.four(), count = cursor.two(), size = cursor.two(),
                      sample = cursor.four();
  if (to_qos < kToInlineQos) return PacketFault::kLength;
  cursor.skip(to_qos - kToInlineQos);
  if (cursor.missing()) return PacketFault::kLength;
  if (sequence <= 0) return PacketFault::kSequence;
  if (built_in(writer)) return PacketFault::kFragment;  // theirs are small
  if (message.has(kSecondFlag)) {
    const PacketFault fault = check_parameters(cursor, Owner());
    if (fault != PacketFault::kNone) return fault;
  }
  if (first == 1 && messages::token_of(cursor.left()) != message.rules.token)
    return PacketFault::kToken;
  if (first == 0 || count == 0 || size == 0 || sample > kMaxSampleBytes ||
      (first + count - 2) * size >= sample) {
    return PacketFault::kFragment;
  }
  const std::uint64_t bytes = std::min(count * size, sample - (first - 1) * size);
  return cursor.left().size() < bytes ? PacketFault::kLength : PacketFault::kNone;
}

PacketFault check_gap(const Submessage& message) {
  Cursor cursor = message.cursor();
  cursor.skip(8);
  const std::int64_t start = cursor.sequence(), base = cursor.sequence();
  const bool fits = set_fits(cursor);
  if (cursor.missing() || !fits) return PacketFault::kLength;
  if (start <= 0 || base < start) return PacketFault::kSequence;
  return base - start > kMaxGap ? PacketFault::kGap : PacketFault::kNone;
}

PacketFault check_heartbeat(const Submessage& message) {
  Cursor cursor = message.cursor();
  cursor.skip(8);
  const std::int64_t first = cursor.sequence(), last = cursor.sequence();
  cursor.skip(4);
  if (cursor.missing()) return PacketFault::kLength;
  return first <= 0 || last < first - 1 ? PacketFault::kSequence : PacketFault::kNone;
}

PacketFault check_acknack(const Submessage& message) {
  Cursor cursor = message.cursor();
  cursor.skip(8);
  const std::int64_t base = cursor.sequence();
  const bool fits = set_fits(cursor);
  cursor.skip(4);
  if (cursor.missing() || !fits) return PacketFault::kLength;
  return base < 0 ? PacketFault::kSequence : PacketFault::kNone;  // 0: "I know nothing yet"
}

PacketFault check_fragment_words(const Submessage& message) {
  Cursor cursor = message.cursor();
  cursor.skip(8);
  const std::int64_t sequence = cursor.sequence();
  const std::uint32_t number = cursor.four();
  const bool fits = message.kind != kNackFrag || set_fits(cursor);
  cursor.skip(4);
  if (cursor.missing() || !fits) return PacketFault::kLength;
  if (sequence <= 0) return PacketFault::kSequence;
  return number == 0 ? PacketFault::kFragment : PacketFault::kNone;
}

PacketFault check_reply(const Submessage& message) {
  Cursor cursor = message.cursor();
  for (int list = 0; list < (message.has(kSecondFlag) ? 2 : 1); ++list) {
    const std::uint32_t locators = cursor.four();
    if (locators > cursor.left().size() / kLocatorBytes) return PacketFault::kLength;
    cursor.skip(locators * kLocatorBytes);
  }
  return checked(cursor);
}

PacketFault at_least(const Submessage& message, std::size_t bytes) {
  return message.content.size() < bytes ? PacketFault::kLength : PacketFault::kNone;
}

// Whether it is from a writer of a topic, or to one.
bool is_of_topic(const Submessage& message) {
  const bool data = message.kind == kData || message.kind == kDataFrag;
  const bool other = message.kind == kGap || message.kind == kHeartbeat ||
                     message.kind == kAckNack || message.kind == kNackFrag ||
                     message.kind == kHeartbeatFrag;
  if (!data && !other) return false;
  Cursor cursor = message.cursor();
  cursor.skip(data ? 8 : 4);
  return !built_in(cursor.entity());
}

PacketFault check(const Submessage& message) {
  if (message.rules.secured && is_of_topic(message)) return PacketFault::kPlain;
  switch (message.kind) {
    case kPad:
      return PacketFault::kNone;
    case kAckNack:
      return check_acknack(message);
    case kHeartbeat:
      return check_heartbeat(message);
    case kGap:
      return check_gap(message);
    case kInfoTimestamp:
      return at_least(message, message.has(kSecondFlag) ? 0 : 8);
    case kInfoReplyIp4:
      return at_least(message, message.has(kSecondFlag) ? 16 : 8);
    case kInfoDestination:
      return at_least(message, 12);
    case kInfoReply:
      return check_reply(message);
    case kNackFrag:
    case kHeartbeatFrag:
      return check_fragment_words(message);
    case kData:
      return check_data(message);
    case kDataFrag:
      return check_data_frag(message);
    default:
      return message.rules.secured && SecuredWords::is_one(message.kind) ? PacketFault::kNone
                                                                         : PacketFault::kKind;
  }
}

// No sample: that a key of a topic is not written any more.
bool ends_key(const Submessage& message) {
  return message.kind == kData && !message.has(kPayloadFlag) && is_of_topic(message);
}

bool is_rtps(Octets packet) {
  return packet.size() >= kRtpsHeaderBytes &&
         std::equal(kRtpsMagic.begin(), kRtpsMagic.end(), packet.begin());
}

}  // namespace

const char* text_of(PacketFault fault) {
  constexpr std::array kTexts{"sound",
                              "not RTPS 2",
                              "a sub-message ends beyond its packet",
                              "a sub-message of unknown kind",
                              "sequence numbers that cannot be",
                              "a gap of more than a million samples",
                              "fragments that do not fit their sample",
                              "a broken list of parameters",
                              "words in another participant's name",
                              "a sample without this session's token",
                              "words on a topic that are not encrypted",
                              "encrypted words that are not whole"};
  return kTexts.at(static_cast<std::size_t>(fault));
}

FilteredPacket filter_packet(Octets packet, const SampleRules& rules,
                             std::vector<std::uint8_t>& kept) {
  if (!is_rtps(packet)) return {{}, PacketFault::kHeader};
  PacketFault last = PacketFault::kNone;
  kept.clear();
  SecuredWords secured;
  std::size_t sound = kRtpsHeaderBytes;  // bytes from the beginning that lost nothing
  for (Octets rest = packet.subspan(kRtpsHeaderBytes); !rest.empty();) {
    const std::optional<std::size_t> size = submessage_size(rest);
    if (!size) return {{}, PacketFault::kLength};
    const bool vendor = rest[0] >= kFirstVendorKind;
    const Submessage message{rest[0], rest[1],
                             rest.subspan(kSubmessageHeaderBytes, *size - kSubmessageHeaderBytes),
                             packet.subspan(kPrefixAt, kGuidPrefixBytes), rules};
    if (rules.secured && !secured.follows(rest.first(*size))) return {{}, PacketFault::kSecured};
    const PacketFault fault = vendor ? PacketFault::kNone : check(message);
    if (fault != PacketFault::kNone) last = fault;
    if (fault != PacketFault::kNone && fault != PacketFault::kGap) return {{}, fault};
    if (!vendor && !ends_key(message) && fault == PacketFault::kNone) {
      const std::size_t at = packet.size() - rest.size();
      if (at == sound) {
        sound += *size;
      } else {
        if (kept.empty()) kept.assign(packet.begin(), packet.begin() + std::ptrdiff_t(sound));
        kept.insert(kept.end(), rest.begin(), rest.begin() + std::ptrdiff_t(*size));
      }
    }
    rest = rest.subspan(*size);
  }
  if (!secured.complete()) return {{}, PacketFault::kSecured};
  const Octets passed = kept.empty() ? packet.first(sound) : Octets(kept);
  return {passed.size() > kRtpsHeaderBytes ? passed : Octets(), last};
}

}  // namespace palpate::bus
