// What bags of ROS 1 and 2 have in common: which topic is meant, and its messages' poses.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "modules/scene/scene.h"
#include "modules/trajectories/pose_collector.h"
#include "modules/trajectories/ros_message.h"

namespace palpate::trajectories {

struct PoseTopic {
  std::string name, type;
};

class PoseTopics {
 public:
  void add(const std::string& name, const std::string& type) { types_[name] = type; }
  /// That of the scene's key `topic`, else the only one with poses.
  /// @throws InputError if there is none or several, naming those there are
  PoseTopic choose(const scene::TrajectoryDevice& config) const;

 private:
  std::map<std::string, std::string> types_;
};

class StampedPoses {
 public:
  StampedPoses(const scene::TrajectoryDevice& config, PoseTopic topic, RosEncoding encoding,
               std::vector<std::string>& warnings);

  /// The topic's next message. @throws InputError as PoseCollector does, and for a topic that
  /// holds the motions of several frames, which would be played as one
  void add(std::span<const std::uint8_t> message);
  std::size_t count() const { return count_; }  ///< messages so far
  std::vector<TimedPose> finish() &&;

 private:
  void note_frame(const StampedPose& stamped);

  std::string file_;
  PoseTopic topic_;
  RosEncoding encoding_;
  double metre_;
  PoseCollector poses_;
  std::size_t count_ = 0;
  std::optional<std::int64_t> origin_;  ///< [s]
  std::vector<std::string> frames_;     ///< "'tool' in 'world'", each once
  std::string frame_, child_frame_;     ///< of the last message
};

}  // namespace palpate::trajectories
