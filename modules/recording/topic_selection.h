// Which topics a recording gets, and how often.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "modules/recording/session_samples.h"

namespace palpate::recording {

class TopicSelection {
 public:
  /// Every sample of every topic.
  TopicSelection() = default;
  /// @param words  "all", "haptic_force", or "node_positions=30": at most 30 samples a second of
  /// each writer and key. What comes later counts; `scene` is always recorded. Empty: all.
  /// @throws InputError for a topic that does not exist, and a rate of a topic of state
  explicit TopicSelection(const std::vector<std::string>& words);

  /// As given to the constructor: "all", or topics and rates in the order of their names.
  std::string text() const;
  bool has(std::string_view topic) const;
  double rate(std::string_view topic) const;  ///< 0: every sample

  /// Of a thinned topic the first sample in each period.
  bool takes(const TopicSample& sample);

 private:
  void add(const std::string& word);

  std::map<std::string, double, std::less<>> rates_;  ///< of the topics there are
  bool all_ = true;
  using Stream = std::tuple<const bus::TopicInfo*, bus::WriterId, messages::KeyBytes>;
  std::map<Stream, std::int64_t> newest_period_;
};

/// What a session in real time leaves: what is felt in full, what is seen as often as a picture. A
/// recording in lockstep holds everything.
inline const std::vector<std::string> kRealTimeTopics{"all", "node_positions=20",
                                                      "contact_model=10", "contacts=20"};

}  // namespace palpate::recording
