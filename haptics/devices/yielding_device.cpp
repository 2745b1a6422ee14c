#include "haptics/devices/yielding_device.h"

#include "modules/core/tolerances.h"

namespace palpate::haptics {

void YieldingDevice::hear(const DeviceSample& said, std::int64_t source_time_ns,
                          std::int64_t now_ns) {
  if (!is_believable(said.pose)) return;
  if (led_ == Led::kByScript) {
    follower_ = MouseDevice({pose_.position, pose_.rotation});
    follower_.read(time_);
  }
  led_ = Led::kFromOutside;
  heard_at_ = time_;
  follower_.hear(said, source_time_ns, now_ns);
}

/// A ramp is followed kRampDelay behind, so the script is aimed at that much ahead.
void YieldingDevice::return_to(const DeviceSample& script) {
  DeviceSample ahead = script;
  ahead.pose.position += MouseDevice::kRampDelay * script.twist.linear;
  follower_.hear(ahead, 0, 0);
  const bool there = (pose_.position - script.pose.position).norm() < kBackWithin &&
                     pose_.rotation.angularDistance(script.pose.rotation) < kTurnedBackWithin;
  if (there) led_ = Led::kByScript;
}

DeviceSample YieldingDevice::read(double time) {
  DeviceSample sample = script_->read(time);
  time_ = time;
  if (led_ == Led::kFromOutside && time - heard_at_ > kGivenBackAfter) led_ = Led::kBack;
  if (led_ == Led::kBack) return_to(sample);
  if (led_ != Led::kByScript) sample = follower_.read(time);
  pose_ = sample.pose;
  return sample;
}

void YieldingDevice::reset() {
  script_->reset();
  led_ = Led::kByScript;
  time_ = heard_at_ = 0;
}

}  // namespace palpate::haptics
