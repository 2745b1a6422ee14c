#include "modules/bus/topics.h"

#include <algorithm>
#include <array>

namespace palpate::bus {

std::span<const TopicInfo> all_topics() {
  static const auto topics =
      std::apply([](const auto&... topic) { return std::array{info_of(topic)...}; }, kTopics);
  return topics;
}

const TopicInfo* find_topic(std::string_view name) {
  const auto topics = all_topics();
  const auto found = std::ranges::find(topics, name, &TopicInfo::name);
  return found == topics.end() ? nullptr : &*found;
}

}  // namespace palpate::bus
