#include "modules/bus/memory_bus.h"

#include <algorithm>
#include <cstring>

namespace palpate::bus {
namespace {

// Samples in order; a new one of a key takes the place of the old where only the newest counts.
class Queue {
 public:
  Queue(const messages::MessageType& type, bool newest_only)
      : type_(type), newest_only_(newest_only) {}

  void push(const WriterId& writer, std::int64_t time_ns, messages::Payload payload) {
    const auto key = newest_only_ ? messages::key_of(type_, payload) : messages::KeyBytes{};
    const auto same =
        !newest_only_ ? entries_.end() : std::ranges::find(entries_, key, &Entry::key);
    if (same != entries_.end()) {
      spare_.splice(spare_.begin(), entries_, same);
    } else if (spare_.empty()) {
      spare_.emplace_front();
    }
    Entry& entry = spare_.front();
    entry.key = key;
    entry.sample.writer = writer;
    entry.sample.received_time_ns = time_ns;
    entry.sample.payload.assign(payload.begin(), payload.end());
    entries_.splice(entries_.end(), spare_, spare_.begin());
  }
  bool pop(RawSample& sample) {
    if (entries_.empty()) return false;
    std::swap(sample, entries_.front().sample);
    spare_.splice(spare_.begin(), entries_, entries_.begin());
    return true;
  }
  bool empty() const { return entries_.empty(); }
  template <class F>
  void for_each(const F& f) const {
    for (const Entry& entry : entries_) f(entry.sample);
  }

 private:
  struct Entry {
    messages::KeyBytes key;
    RawSample sample;
  };
  const messages::MessageType& type_;
  bool newest_only_;
  std::list<Entry> entries_;
  std::list<Entry> spare_;  // memory for new ones
};

}  // namespace

class MemoryBus::MemoryReader : public RawReader {
 public:
  MemoryReader(Endpoints& endpoints, const TopicInfo& topic, bool newest_only);
  ~MemoryReader() override { std::erase(endpoints_.readers, this); }

  void receive(const RawSample& sample) {
    queue_.push(sample.writer, sample.received_time_ns, sample.payload);
  }
  bool take(RawSample& sample) override { return queue_.pop(sample); }
  bool wait(double) override { return !queue_.empty(); }
  int matched_writers() const override { return static_cast<int>(endpoints_.writers.size()); }

 private:
  friend class MemoryWriter;
  Endpoints& endpoints_;
  Queue queue_;
};

class MemoryBus::MemoryWriter : public RawWriter {
 public:
  MemoryWriter(MemoryBus& bus, Endpoints& endpoints, const TopicInfo& topic)
      : bus_(bus),
        endpoints_(endpoints),
        is_state_(topic.delivery == Delivery::kState),
        kept_(*topic.type, !bus.every_sample_) {
    const std::uint64_t number = ++bus.writer_count_;
    std::memcpy(id_.data(), &number, sizeof number);
    endpoints_.writers.push_back(this);
  }
  ~MemoryWriter() override { std::erase(endpoints_.writers, this); }

  bool write(messages::Payload payload) override {
    const std::int64_t now_ns = bus_.now_ns();
    for (MemoryReader* reader : endpoints_.readers) reader->queue_.push(id_, now_ns, payload);
    if (is_state_) kept_.push(id_, now_ns, payload);
    return true;
  }
  int matched_readers() const override { return static_cast<int>(endpoints_.readers.size()); }
  bool wait_until_received(double) override { return true; }
  /// What a late reader of a state gets.
  const Queue& kept() const { return kept_; }

 private:
  MemoryBus& bus_;
  Endpoints& endpoints_;
  bool is_state_;
  WriterId id_{};
  Queue kept_;
};

MemoryBus::MemoryReader::MemoryReader(Endpoints& endpoints, const TopicInfo& topic,
                                      bool newest_only)
    : endpoints_(endpoints), queue_(*topic.type, newest_only) {
  for (const MemoryWriter* writer : endpoints_.writers) {
    writer->kept().for_each([this](const RawSample& sample) { receive(sample); });
  }
  endpoints_.readers.push_back(this);
}

std::unique_ptr<RawWriter> MemoryBus::raw_writer(const TopicInfo& topic) {
  return std::make_unique<MemoryWriter>(*this, topics_[std::string(topic.name)], topic);
}

std::unique_ptr<RawReader> MemoryBus::raw_reader(const TopicInfo& topic, Keep keep) {
  const bool newest_only = keep == Keep::kNewest && !every_sample_;
  return std::make_unique<MemoryReader>(topics_[std::string(topic.name)], topic, newest_only);
}

}  // namespace palpate::bus
