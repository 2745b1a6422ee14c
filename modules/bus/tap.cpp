#include "modules/bus/tap.h"

#include <deque>

namespace palpate::bus {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes copy_of(messages::Payload payload) { return {payload.begin(), payload.end()}; }

class TappedWriter : public RawWriter {
 public:
  TappedWriter(const Bus& bus, const TopicInfo& topic, std::unique_ptr<RawWriter> writer,
               std::vector<Tap> taps)
      : bus_(bus), topic_(topic), writer_(std::move(writer)), taps_(std::move(taps)) {}

  bool write(messages::Payload payload) override {
    written_ = true;
    pass(0, payload);
    return written_;
  }
  int matched_readers() const override { return writer_->matched_readers(); }
  bool wait_until_received(double longest) override {
    return writer_->wait_until_received(longest);
  }

 private:
  void pass(std::size_t tap, messages::Payload payload) {
    if (tap == taps_.size()) {
      written_ = writer_->write(payload) && written_;
      return;
    }
    taps_[tap]({topic_, payload, bus_.now_ns()},
               [this, tap](messages::Payload next) { pass(tap + 1, next); });
  }

  const Bus& bus_;
  TopicInfo topic_;
  std::unique_ptr<RawWriter> writer_;
  std::vector<Tap> taps_;
  bool written_ = true;
};

}  // namespace

void TappedBus::set_tap(std::string_view topic, Tap tap) {
  taps_[std::string(topic)].push_back(std::move(tap));
}

std::unique_ptr<RawWriter> TappedBus::raw_writer(const TopicInfo& topic) {
  auto writer = bus_.raw_writer(topic);
  const auto taps = taps_.find(topic.name);
  if (taps == taps_.end()) return writer;
  return std::make_unique<TappedWriter>(*this, topic, std::move(writer), taps->second);
}

std::unique_ptr<RawReader> TappedBus::raw_reader(const TopicInfo& topic, Keep keep) {
  return bus_.raw_reader(topic, keep);
}

Tap record_tap(std::function<void(const Passing&)> record) {
  return [record = std::move(record)](const Passing& passing, const Forward& forward) {
    record(passing);
    forward(passing.payload);
  };
}

Tap delay_tap(std::size_t samples) {
  return [samples, waiting = std::deque<Bytes>()](const Passing& passing,
                                                  const Forward& forward) mutable {
    waiting.push_back(copy_of(passing.payload));
    if (waiting.size() <= samples) return;
    forward(waiting.front());
    waiting.pop_front();
  };
}

Tap time_delay_tap(std::int64_t delay_ns) {
  return [delay_ns, waiting = std::deque<std::pair<std::int64_t, Bytes>>()](
             const Passing& passing, const Forward& forward) mutable {
    waiting.emplace_back(passing.now_ns + delay_ns, copy_of(passing.payload));
    while (!waiting.empty() && waiting.front().first <= passing.now_ns) {
      forward(waiting.front().second);
      waiting.pop_front();
    }
  };
}

Tap lose_tap(std::function<bool(const Passing&)> lost) {
  return [lost = std::move(lost)](const Passing& passing, const Forward& forward) {
    if (!lost(passing)) forward(passing.payload);
  };
}

Tap repeat_tap(std::size_t times) {
  return [times](const Passing& passing, const Forward& forward) {
    for (std::size_t i = 0; i < times; ++i) forward(passing.payload);
  };
}

Tap tap_while(std::function<bool(const Passing&)> acts, Tap tap) {
  return [acts = std::move(acts), tap = std::move(tap)](const Passing& passing,
                                                        const Forward& forward) mutable {
    acts(passing) ? tap(passing, forward) : forward(passing.payload);
  };
}

}  // namespace palpate::bus
