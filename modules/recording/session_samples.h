// Samples of all topics of a session as the bytes that travel, to and from any bus.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "modules/bus/bus.h"

namespace palpate::recording {

struct TopicSample : bus::RawSample {
  const bus::TopicInfo* topic = nullptr;  ///< of bus::all_topics()
};

/// Hears the topics of a session.
class SessionReader {
 public:
  /// @param wanted  which topics; none given: every one
  explicit SessionReader(bus::Bus& bus, const std::function<bool(std::string_view)>& wanted = {});

  /// All samples that have arrived and were not taken, in the order they arrived. The samples keep
  /// their memory for the next call; valid until then.
  std::span<const TopicSample> take_all();

  /// Writers heard of, of all topics.
  int matched_writers() const;
  /// Of one; none if it is not wanted.
  std::optional<int> matched_writers(std::string_view topic) const;

 private:
  std::vector<std::unique_ptr<bus::RawReader>>
      readers_;  ///< as bus::all_topics(); null: not wanted
  std::vector<TopicSample> samples_;
};

/// Writes recorded samples into a session.
class SessionWriter {
 public:
  explicit SessionWriter(bus::Bus& bus);

  /// False if the bus refused it.
  bool write(const bus::TopicInfo& topic, messages::Payload payload);

  /// Readers of a topic.
  int matched_readers(const bus::TopicInfo& topic) const;

  /// Waits until every reader of the state topics has all samples. timeout in seconds, per topic.
  void wait_until_received(double timeout);

 private:
  bus::RawWriter& writer_of(const bus::TopicInfo& topic) const;
  std::vector<std::unique_ptr<bus::RawWriter>> writers_;  ///< as bus::all_topics()
};

}  // namespace palpate::recording
