#include "modules/trajectories/motion_facts.h"

#include <algorithm>

namespace palpate::trajectories {

MotionFacts facts_of(const std::vector<TimedPose>& poses) {
  MotionFacts facts;
  facts.poses = poses.size();
  facts.duration = poses.back().time - poses.front().time;
  Eigen::AlignedBox3d box;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    box.extend(poses[i].pose.position);
    if (i == 0) continue;
    const Vec3 way = poses[i].pose.position - poses[i - 1].pose.position;
    facts.fastest = std::max(facts.fastest, way.norm() / (poses[i].time - poses[i - 1].time));
  }
  facts.extent = box.sizes();
  return facts;
}

}  // namespace palpate::trajectories
