// Steps of the force while the probe slides over the whole organ, row by row.
#pragma once

#include "haptics/devices/trajectory.h"
#include "studies/certify/line.h"
#include "studies/certify/loop.h"

namespace palpate::certify {

/// Rows over the side of the organ that the scene touches, parallel, one through the place of
/// touch, each pressed in, slid along and left. Half of subject.depth below the skin at rest, along
/// `into`; only where the skin leans by less than 50° and is not held nearby.
/// @param rows  at most as many, the one through the place first; 0: all
/// @returns none for a probe without a round tip
std::vector<haptics::TimedPose> slide_path(const Subject& subject, int rows);

struct SlideTick {
  double time = 0;
  Vec3 position = Vec3::Zero();
  double force = 0, step = 0;  ///< of the rendered force, and its change since the tick before [N]
  double over() const;         ///< the step over what a hand feels as one
};
std::vector<SlideTick> slide(const Loop& loop, const std::vector<haptics::TimedPose>& path,
                             const KeepGoing& keep_going);
Line slide_line(const std::vector<SlideTick>& ticks);

}  // namespace palpate::certify
