#include "haptics/device.h"

#include "haptics/scripted_device.h"
#include "haptics/trajectory.h"
#include "haptics/trajectory_file.h"

namespace palpate::haptics {
namespace {

/// Plays a recording, placed in the world.
class TrajectoryDevice final : public Device {
 public:
  TrajectoryDevice(const scene::TrajectoryDevice& config, std::vector<std::string>& warnings)
      : trajectory_(read_in_world(config, warnings), config.loop) {}

  DeviceSample read(double time) override { return trajectory_.at(time); }

 private:
  static std::vector<TimedPose> read_in_world(const scene::TrajectoryDevice& config,
                                              std::vector<std::string>& warnings) {
    std::vector<TimedPose> samples = read_trajectory(config.file, warnings);
    const Quat R_WR = config.offset.rotation.normalized();
    for (TimedPose& sample : samples) {
      sample.pose.position = config.offset.position + R_WR * sample.pose.position;
      sample.pose.rotation = (R_WR * sample.pose.rotation).normalized();
    }
    return samples;
  }

  Trajectory trajectory_;
};

}  // namespace

std::unique_ptr<Device> make_device(const scene::Device& device,
                                    std::vector<std::string>& warnings) {
  if (const auto* trajectory = std::get_if<scene::TrajectoryDevice>(&device)) {
    return std::make_unique<TrajectoryDevice>(*trajectory, warnings);
  }
  if (const auto* script = std::get_if<scene::ScriptedDevice>(&device)) {
    return std::make_unique<ScriptedDevice>(*script);
  }
  return std::make_unique<TopicDevice>(std::get<scene::TopicDevice>(device));
}

}  // namespace palpate::haptics
