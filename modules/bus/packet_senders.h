// Who may speak as which participant.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>

namespace palpate::bus {

/// The twelve bytes of an RTPS header that name a participant.
using GuidPrefix = std::array<std::uint8_t, 12>;

/// Where a packet came from: IPv4 address, UDP port. A port belongs to one socket of one process,
/// and nobody outside the host comes in over the loopback: a sender cannot be forged there.
struct PacketSender {
  std::uint32_t address = 0;
  std::uint16_t port = 0;
  auto operator<=>(const PacketSender&) const = default;
};

/// Holds every participant to the sender that was first heard to be it, so that no other program
/// can end, replace or answer for it; and every sender to one participant at a time. Thread-safe.
class PacketSenders {
 public:
  /// Whether `sender` may speak as `participant`. A sender whose participant was silent for
  /// kSilence may become another one: a port that was given back. Of those silent for kForgotten
  /// the oldest makes room when kMaxParticipants are known; if none is, newcomers are refused.
  bool admit(const GuidPrefix& participant, const PacketSender& sender, std::int64_t now_ns);

  /// Where a participant speaks from; nothing if it is not known.
  std::optional<PacketSender> sender_of(const GuidPrefix& participant) const;

  static constexpr std::int64_t kSilence = 1'000'000'000;     ///< four announcements [ns]
  static constexpr std::int64_t kForgotten = 10'000'000'000;  ///< [ns]
  static constexpr std::size_t kMaxParticipants = 256;

 private:
  struct Known {
    PacketSender sender;
    std::int64_t heard_ns = 0;
  };
  bool admit_newcomer(const GuidPrefix& participant, const PacketSender& sender,
                      std::int64_t now_ns);
  bool make_room(std::int64_t now_ns);

  mutable std::mutex mutex_;
  std::map<GuidPrefix, Known> known_;
  std::map<PacketSender, GuidPrefix> participants_;  ///< the inverse
};

}  // namespace palpate::bus
