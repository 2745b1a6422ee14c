// Asks the clocks of the other hosts' processes, and answers: topic `clock`, in a thread of its
// own.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "modules/bus/clock_offset.h"
#include "modules/bus/host_clocks.h"
#include "modules/bus/raw_bus.h"
#include "modules/messages/messages.h"

namespace palpate::bus {

/// One process's part, without a thread or a clock: what it hears, and what it says next.
class ClockConversation {
 public:
  /// @param process  a number that no other process has
  explicit ClockConversation(std::uint32_t process) { own_.process = process; }

  /// Something that another host's process said came at `received_ns`. @returns what is now known
  /// of its clock; nullptr before the first round trip
  const ClockOffset* hear(const ClockExchange& said, std::int64_t received_ns);
  /// To be said now, stamped by whoever sends it. Who was silent for kSilence is not answered.
  ClockExchange& speak(std::int64_t now_ns);

  static constexpr std::int64_t kSilence = 10'000'000'000;  ///< [ns]

 private:
  struct Peer {
    ClockExchange::Echo heard;
    std::int64_t answered_ns = 0;  ///< which of ours its last echo was of
    ClockOffset offset;
  };
  ClockExchange own_;
  std::map<std::uint32_t, Peer> peers_;
};

/// The conversation over a bus, twenty times a second.
class ClockExchanger {
 public:
  ClockExchanger(std::unique_ptr<RawWriter> writer, std::unique_ptr<RawReader> reader,
                 HostClocks& clocks);
  ~ClockExchanger();

 private:
  void run();
  void listen();
  void say();

  std::unique_ptr<RawWriter> writer_;
  std::unique_ptr<RawReader> reader_;
  HostClocks& clocks_;
  ClockConversation conversation_;
  ClockExchange heard_;
  RawSample sample_;
  std::vector<std::uint8_t> payload_;
  std::uint64_t sequence_ = 0;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool ended_ = false;
  std::thread thread_;  ///< last: it uses all others
};

}  // namespace palpate::bus
