// Which RTPS packets may reach the DDS library. Debian's Fast DDS 2.9.1 answers malformed ones with
// assertions, endless loops or as much memory as they ask for.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace palpate::bus {

enum class PacketFault {
  kNone,
  kHeader,      ///< not RTPS 2
  kLength,      ///< a sub-message, or what it holds, ends beyond the packet
  kKind,        ///< a sub-message that the standard does not have, or of DDS Security
  kSequence,    ///< sequence numbers not above 0, or out of order
  kGap,         ///< a GAP over more than kMaxGap samples
  kFragment,    ///< fragments that do not fit their sample, or a sample beyond kMaxSampleBytes
  kParameters,  ///< a parameter list without its end, or with a wrong length
  kIdentity,    ///< discovery of another participant than the packet's own, or its name taken
  kToken,       ///< a sample of another session
  kPlain,       ///< of a topic, and not encrypted
  kSecured,     ///< encrypted words without their beginning or end, or with other lengths
};
const char* text_of(PacketFault fault);  ///< one line, without a full stop

/// The widest gap that may pass [samples]: what a writer of statuses says in 3 days.
inline constexpr std::int64_t kMaxGap = 1 << 20;
/// The largest message, a topology of an organ at its limits, and room to spare [bytes].
inline constexpr std::size_t kMaxSampleBytes = std::size_t{64} << 20;

/// What samples of topics must be like.
struct SampleRules {
  std::uint64_t token = 0;  ///< they bear it (messages::token_of)
  bool secured = false;     ///< they come encrypted, or not at all
};

struct FilteredPacket {
  std::span<const std::uint8_t> packet;    ///< empty if nothing of it may pass
  PacketFault fault = PacketFault::kNone;  ///< the last one found
};

/// Keeps the sub-messages that RTPS 2.5 (OMG formal/22-04-01, section 9.4.5) describes, well formed
/// and within our own limits; leaves out those of vendors, which the standard lets every reader
/// ignore, and what ends a key of a topic, for nothing of ours does. A fault refuses the whole
/// packet, except a GAP that is too wide, which alone is left out.
/// @param packet  of any content and size
/// @param kept    memory for what is kept of a packet that loses something in its middle
FilteredPacket filter_packet(std::span<const std::uint8_t> packet, const SampleRules& rules,
                             std::vector<std::uint8_t>& kept);

}  // namespace palpate::bus
