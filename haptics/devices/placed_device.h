// A device that is where it was put last: for whoever moves a probe from outside, step by step.
#pragma once

#include "haptics/devices/device.h"

namespace palpate::haptics {

class PlacedDevice final : public Device {
 public:
  explicit PlacedDevice(const Pose& pose) { sample_.pose = pose; }
  /// There from the next read() on. @param twist  in W
  void place(const Pose& pose, const Twist& twist = {}) {
    sample_.pose = pose;
    sample_.twist = twist;
  }
  DeviceSample read(double) override { return sample_; }

  void exchange(StateArchive& archive) override { archive(sample_); }

 private:
  DeviceSample sample_;
};

}  // namespace palpate::haptics
