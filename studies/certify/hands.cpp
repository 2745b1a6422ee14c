#include "studies/certify/hands.h"

namespace palpate::certify {

scene::EmulatedDevice firm_hand(const scene::EmulatedDevice& device, const Place& place,
                                std::vector<scene::ScriptedDevice::Move> moves) {
  scene::EmulatedDevice held = device;
  const Pose above = pose_below(place, -kAbove);
  held.start = above.position;
  held.rotation = above.rotation;
  held.hand = {0.2, 10, 500, Vec3::Zero(), std::move(moves)};
  return held;
}

scene::EmulatedDevice pushing_hand(const scene::EmulatedDevice& device, const Place& place,
                                   double push) {
  scene::EmulatedDevice held = device;
  held.start = place.pose.position;
  held.rotation = place.pose.rotation;
  held.axis = place.into;
  held.hand = {};
  held.hand.push = push * place.into;
  return held;
}

double delay_of(const scene::EmulatedDevice& device) { return 2 * device.transport_delay; }

}  // namespace palpate::certify
