#include "haptics/devices/scripted_device.h"

#include <algorithm>

#include "modules/core/error.h"

namespace palpate::haptics {

ScriptedDevice::ScriptedDevice(const scene::ScriptedDevice& script)
    : start_(script.start), rotation_(script.rotation.normalized()) {
  double begin = 0;
  Vec3 from = start_;
  for (const scene::ScriptedDevice::Move& move : script.moves) {
    PALPATE_DEMAND(move.duration > 0);
    const Vec3 to = move.to.value_or(from);
    moves_.push_back({begin, move.duration, from, to});
    begin += move.duration;
    from = to;
  }
}

DeviceSample ScriptedDevice::read(double time) {
  DeviceSample sample;
  sample.pose = {start_, rotation_};
  const auto next = std::upper_bound(moves_.begin(), moves_.end(), time,
                                     [](double t, const Move& move) { return t < move.begin; });
  if (next == moves_.begin()) return sample;
  const Move& move = *(next - 1);
  const double s = std::clamp((time - move.begin) / move.duration, 0.0, 1.0);
  const Vec3 way = move.to - move.from;
  sample.pose.position = move.from + s * s * s * (10 - 15 * s + 6 * s * s) * way;
  sample.twist.linear = 30 * s * s * (1 - s) * (1 - s) / move.duration * way;
  return sample;
}

}  // namespace palpate::haptics
