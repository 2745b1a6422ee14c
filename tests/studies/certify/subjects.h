// A ball that a finger touches from above, and walls, for tests of certificates.
#pragma once

#include "studies/certify/subject.h"
#include "tests/palpate/ball_scene.h"

namespace palpate::testing {

inline const std::function<void()> kGoOn = [] {};

/// Down onto the ball's top: at 1 s it is 1 cm deep.
inline constexpr const char* kFingerFromAbove =
    "scripted: {start_m: [0, 0, 0.09], moves: [{to_m: [0, 0, 0.05], duration_s: 1}]}";

/// For walls: no organ, a Touch-class device.
inline certify::Subject wall_subject() {
  certify::Subject subject;
  subject.scene.probes.push_back({"tip", scene::SphereShape{}, 0, scene::ScriptedDevice{}});
  return subject;
}

}  // namespace palpate::testing
