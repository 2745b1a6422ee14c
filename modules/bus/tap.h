// Taps sit between a bus and its writers: they see each payload written on a topic, and record,
// delay, lose, repeat or change it. Faults and measurements then need no second wiring of a
// session: its stages run on a tapped bus.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "modules/bus/bus.h"
#include "modules/messages/cdr.h"

namespace palpate::bus {

struct Passing {
  const TopicInfo& topic;
  messages::Payload payload;
  std::int64_t now_ns;  ///< by the bus's clock
};
using Forward = std::function<void(messages::Payload)>;

/// Calls `forward` with what shall travel on: nothing, the payload, another, or older ones. Each
/// writer has a copy of its own, with whatever the tap remembers.
using Tap = std::function<void(const Passing& passing, const Forward& forward)>;

/// Another bus with taps on its writers. Readers are those of the other bus.
class TappedBus : public Bus {
 public:
  /// `bus` must outlive it. Its clock is asked, unless this one gets its own.
  explicit TappedBus(Bus& bus) : bus_(bus) {
    set_clock([&bus] { return bus.now_ns(); });
  }

  /// For writers made from now on; several taps of a topic act in the order they were set.
  void set_tap(std::string_view topic, Tap tap);

  std::unique_ptr<RawWriter> raw_writer(const TopicInfo& topic) override;
  std::unique_ptr<RawReader> raw_reader(const TopicInfo& topic, Keep keep) override;
  void flush() override { bus_.flush(); }

 private:
  Bus& bus_;
  std::map<std::string, std::vector<Tap>, std::less<>> taps_;
};

/// Hands every payload to `record` too.
Tap record_tap(std::function<void(const Passing&)> record);

/// Each payload travels when `samples` more have been written.
Tap delay_tap(std::size_t samples);
/// Each payload travels with the first one written at least `delay_ns` later.
Tap time_delay_tap(std::int64_t delay_ns);

/// Payloads for which `lost` is true do not travel.
Tap lose_tap(std::function<bool(const Passing&)> lost);

/// Each payload travels `times` times.
Tap repeat_tap(std::size_t times);

/// Changes the message. With checks, one that is no longer valid does not travel, as if its writer
/// had refused it; without, its reader must refuse it.
template <class Message>
Tap change_tap(std::function<void(Message&)> change, bool checked) {
  return [change = std::move(change), checked, message = Message(),
          changed = std::vector<std::uint8_t>()](const Passing& passing,
                                                 const Forward& forward) mutable {
    if (messages::read_payload(passing.payload, message) != nullptr) return;
    change(message);
    if (!checked) {
      messages::write_payload(message, changed);
    } else if (messages::encode(message, changed) != nullptr) {
      return;
    }
    forward(changed);
  };
}

/// `tap` while `acts` is true of what is written; the rest travels as it is.
Tap tap_while(std::function<bool(const Passing&)> acts, Tap tap);

}  // namespace palpate::bus
