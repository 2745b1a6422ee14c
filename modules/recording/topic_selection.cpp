#include "modules/recording/topic_selection.h"

#include <spdlog/fmt/fmt.h>

#include <charconv>
#include <cmath>

#include "modules/core/error.h"

namespace palpate::recording {
namespace {

constexpr double kHighestRate = 1e4;  // [Hz]

bool can_be_thinned(const bus::TopicInfo& topic) {
  return topic.delivery == bus::Delivery::kStream;
}

double rate_in(const std::string& word, std::string_view text) {
  double rate = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), rate);
  const bool number = error == std::errc{} && end == text.data() + text.size();
  if (!number || !(rate > 0) || rate > kHighestRate) {
    throw InputError("topics: '" + word + "': the rate must be a number in (0, 10000] Hz");
  }
  return rate;
}

std::string topic_names() {
  std::string names;
  for (const bus::TopicInfo& topic : bus::all_topics()) {
    names.append(names.empty() ? "" : ", ").append(topic.name);
  }
  return names;
}

}  // namespace

TopicSelection::TopicSelection(const std::vector<std::string>& words) : all_(words.empty()) {
  for (const auto& word : words) add(word);
  rates_.try_emplace(std::string(bus::kScene.name), 0);
}

void TopicSelection::add(const std::string& word) {
  if (word == "all") {
    for (const bus::TopicInfo& topic : bus::all_topics()) rates_[std::string(topic.name)] = 0;
    return;
  }
  const std::string name = word.substr(0, word.find('='));
  const bus::TopicInfo* topic = bus::find_topic(name);
  if (topic == nullptr) {
    throw InputError("topics: there is no topic '" + name + "'; there are all, " + topic_names());
  }
  double& rate = rates_[name] = 0;
  if (name.size() == word.size()) return;
  if (!can_be_thinned(*topic)) {
    throw InputError("topics: '" + word + "': every sample of " + name + " counts; write " + name);
  }
  rate = rate_in(word, std::string_view(word).substr(name.size() + 1));
}

std::string TopicSelection::text() const {
  if (all_) return "all";
  std::string text;
  for (const auto& [topic, rate] : rates_) {
    text += (text.empty() ? "" : ",") + topic;
    if (rate > 0) text += fmt::format("={}", rate);
  }
  return text;
}

bool TopicSelection::has(std::string_view topic) const { return all_ || rates_.contains(topic); }

double TopicSelection::rate(std::string_view topic) const {
  const auto found = rates_.find(topic);
  return found == rates_.end() ? 0 : found->second;
}

bool TopicSelection::takes(const TopicSample& sample) {
  if (all_) return true;
  const auto chosen = rates_.find(sample.topic->name);
  if (chosen == rates_.end()) return false;
  if (chosen->second == 0) return true;
  const auto period = static_cast<std::int64_t>(
      std::floor(1e-9 * static_cast<double>(sample.received_time_ns) * chosen->second));
  const Stream stream{sample.topic, sample.writer,
                      messages::key_of(*sample.topic->type, sample.payload)};
  const auto [place, first] = newest_period_.try_emplace(stream, period);
  if (!first && place->second == period) return false;
  place->second = period;
  return true;
}

}  // namespace palpate::recording
