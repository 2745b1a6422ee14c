// What each participant's clock is worth on this host, for readers that may not wait.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>

#include "modules/bus/clock_offset.h"
#include "modules/bus/packet_senders.h"
#include "modules/bus/sequence_gaps.h"

namespace palpate::bus {

GuidPrefix participant_of(const WriterId& writer);

/// A table of participants. Reading it neither locks nor allocates, but for the first sample of a
/// participant.
class HostClocks {
 public:
  struct Reading {
    bool known = true;
    std::int64_t shift_ns = 0;  ///< ours − theirs; exactly 0 for participants of this host
    double error = 0;           ///< [s]
  };
  /// The host of a participant as "10.0.0.6"; empty for one of this host.
  using HostOf = std::function<std::string(const GuidPrefix&)>;

  explicit HostClocks(HostOf host_of) : host_of_(std::move(host_of)) {}

  /// @param now_ns  the error grows with the time since set(), by ClockOffset::kMostDrift
  Reading of(const WriterId& writer, std::int64_t now_ns);
  bool is_of_this_host(const GuidPrefix& participant) { return entry(participant)->own; }

  /// By the exchange, again and again.
  void set(const GuidPrefix& participant, const ClockOffset::Estimate& estimate,
           std::uint64_t jumps, std::int64_t now_ns);
  /// Something of it came that could not be used, as of `now_ns`.
  void missed(const WriterId& writer, std::int64_t now_ns);

  /// A sentence naming a host whose clock is missed, or was set anew within kJumpShown; else empty.
  const char* trouble(std::int64_t now_ns) const;

  static constexpr std::size_t kMostParticipants = 1024;
  static constexpr std::int64_t kPatience = 2'000'000'000;   ///< for the first exchange [ns]
  static constexpr std::int64_t kForgotten = 3'000'000'000;  ///< missed no more [ns]
  static constexpr std::int64_t kJumpShown = 5'000'000'000;  ///< [ns]

 private:
  struct Entry {
    GuidPrefix participant{};
    bool own = false;
    std::string unknown_text, jumped_text;
    std::atomic<bool> known{false};
    std::atomic<std::int64_t> shift_ns{0};
    std::atomic<double> error{0};
    std::atomic<std::int64_t> set_ns{0};
    std::atomic<std::int64_t> first_missed_ns{0}, missed_ns{0}, jumped_ns{0};
    std::uint64_t jumps = 0;
  };
  Entry* entry(const GuidPrefix& participant);
  Entry* find(const GuidPrefix& participant);

  HostOf host_of_;
  std::array<Entry, kMostParticipants> entries_;
  std::atomic<std::size_t> used_{0};
  std::mutex adding_;
};

}  // namespace palpate::bus
