#include "modules/recording/session_samples.h"

#include <algorithm>

#include "modules/core/error.h"

namespace palpate::recording {
namespace {

/// The fastest are small: of them a second is kept, as of the others.
bus::Keep keep_of(const bus::TopicInfo& topic) {
  const bool fast = topic.name == bus::kProbeState.name || topic.name == bus::kProbeInput.name ||
                    topic.name == bus::kHapticForce.name;
  return fast ? bus::Keep::kLongBacklog : bus::Keep::kBacklog;
}

}  // namespace

SessionReader::SessionReader(bus::Bus& bus, const std::function<bool(std::string_view)>& wanted) {
  for (const bus::TopicInfo& topic : bus::all_topics()) {
    const bool heard = !wanted || wanted(topic.name);
    readers_.push_back(heard ? bus.raw_reader(topic, keep_of(topic)) : nullptr);
  }
}

std::span<const TopicSample> SessionReader::take_all() {
  std::size_t used = 0;
  const auto next = [&]() -> TopicSample& {
    if (used == samples_.size()) samples_.emplace_back();
    return samples_[used];
  };
  for (std::size_t i = 0; i < readers_.size(); ++i) {
    while (readers_[i] && readers_[i]->take(next())) samples_[used++].topic = &bus::all_topics()[i];
  }
  const std::span<TopicSample> taken(samples_.data(), used);
  std::ranges::stable_sort(taken, {}, &TopicSample::received_time_ns);
  return taken;
}

int SessionReader::matched_writers() const {
  int count = 0;
  for (const auto& reader : readers_) {
    if (reader) count += reader->matched_writers();
  }
  return count;
}

std::optional<int> SessionReader::matched_writers(std::string_view topic) const {
  for (std::size_t i = 0; i < readers_.size(); ++i) {
    if (readers_[i] && bus::all_topics()[i].name == topic) return readers_[i]->matched_writers();
  }
  return std::nullopt;
}

SessionWriter::SessionWriter(bus::Bus& bus) {
  for (const bus::TopicInfo& topic : bus::all_topics()) writers_.push_back(bus.raw_writer(topic));
}

bus::RawWriter& SessionWriter::writer_of(const bus::TopicInfo& topic) const {
  const auto place = std::ranges::find(bus::all_topics(), topic.name, &bus::TopicInfo::name);
  PALPATE_DEMAND(place != bus::all_topics().end());
  return *writers_[static_cast<std::size_t>(place - bus::all_topics().begin())];
}

bool SessionWriter::write(const bus::TopicInfo& topic, messages::Payload payload) {
  return writer_of(topic).write(payload);
}

int SessionWriter::matched_readers(const bus::TopicInfo& topic) const {
  return writer_of(topic).matched_readers();
}

void SessionWriter::wait_until_received(double timeout) {
  for (const bus::TopicInfo& topic : bus::all_topics()) {
    if (topic.delivery == bus::Delivery::kState) writer_of(topic).wait_until_received(timeout);
  }
}

}  // namespace palpate::recording
