// A device that Python guides: it was put somewhere and goes on from there at the velocity it was
// given.
#pragma once

#include "haptics/devices/device.h"
#include "modules/core/rotation_vector.h"

namespace palpate::python {

class GuidedDevice final : public haptics::Device {
 public:
  /// There at the next read(). @param twist  in W
  void guide(const Pose& pose, const Twist& twist) {
    sample_.pose = from_ = pose;
    sample_.twist = twist;
    began_ = kNotYet;
  }
  haptics::DeviceSample read(double time) override {
    if (began_ == kNotYet) began_ = time;
    const double gone = time - began_;
    sample_.pose.position = from_.position + gone * sample_.twist.linear;
    sample_.pose.rotation =
        (rotation_from_vector(gone * sample_.twist.angular) * from_.rotation).normalized();
    return sample_;
  }
  void exchange(StateArchive& archive) override { archive(from_, sample_, began_); }

 private:
  static constexpr double kNotYet = -1;
  Pose from_;
  haptics::DeviceSample sample_;
  double began_ = kNotYet;  ///< session time [s]
};

}  // namespace palpate::python
