#include "haptics/devices/device.h"

#include "haptics/devices/emulated_device.h"
#include "haptics/devices/mouse_device.h"
#include "haptics/devices/scripted_device.h"
#include "haptics/devices/topic_device.h"
#include "haptics/devices/trajectory.h"
#include "haptics/devices/yielding_device.h"
#include "modules/trajectories/trajectory_file.h"

namespace palpate::haptics {
namespace {

/// Plays a recording, placed in the world.
class TrajectoryDevice final : public Device {
 public:
  explicit TrajectoryDevice(Trajectory trajectory) : trajectory_(std::move(trajectory)) {}
  DeviceSample read(double time) override { return trajectory_.at(time); }

 private:
  Trajectory trajectory_;
};

}  // namespace

std::unique_ptr<Device> make_player(const scene::TrajectoryDevice& config,
                                    std::vector<TimedPose> samples) {
  const Quat R_WR = config.offset.rotation.normalized();
  for (TimedPose& sample : samples) {
    sample.pose.position = config.offset.position + R_WR * sample.pose.position;
    sample.pose.rotation = (R_WR * sample.pose.rotation).normalized();
  }
  return std::make_unique<YieldingDevice>(
      std::make_unique<TrajectoryDevice>(Trajectory(std::move(samples), config.loop)));
}

std::unique_ptr<Device> make_device(const scene::Device& device, const scene::Haptics& haptics,
                                    std::vector<std::string>& warnings) {
  if (const auto* trajectory = std::get_if<scene::TrajectoryDevice>(&device)) {
    return make_player(*trajectory, trajectories::read_trajectory(*trajectory, warnings));
  }
  if (const auto* script = std::get_if<scene::ScriptedDevice>(&device)) {
    return std::make_unique<YieldingDevice>(std::make_unique<ScriptedDevice>(*script));
  }
  if (const auto* emulated = std::get_if<scene::EmulatedDevice>(&device)) {
    return std::make_unique<EmulatedDevice>(*emulated);
  }
  if (const auto* mouse = std::get_if<scene::MouseDevice>(&device)) {
    return std::make_unique<MouseDevice>(*mouse);
  }
  return std::make_unique<TopicDevice>(std::get<scene::TopicDevice>(device), haptics);
}

}  // namespace palpate::haptics
