#include "collision/approach.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "collision/contact_finder.h"
#include "modules/geometry/aabb_tree.h"

namespace palpate::collision {
namespace {

constexpr ContactLimits kEnough{64, 16, 4096};
constexpr double kMargin = 1e-6;  // [m]: touching, not near

bool touches(const ContactSet& found) { return !found.empty() && found.deepest_gap() <= 0; }

}  // namespace

Approach approach_of(const geometry::ProbeForm& probe,
                     const std::vector<geometry::TriangleSurface>& surfaces,
                     const std::function<Pose(double)>& pose_at, double duration) {
  std::vector<std::vector<geometry::Triangle>> triangles;
  std::vector<geometry::AabbTree> trees;
  for (const auto& surface : surfaces) {
    triangles.push_back(surface.triangles);
    trees.emplace_back(surface);
  }
  ContactFinder finder(triangles, {probe});
  for (std::size_t i = 0; i < surfaces.size(); ++i) finder.update_organ(i, surfaces[i].nodes);

  Approach approach;
  approach.duration = duration;
  double squared_nearest = std::numeric_limits<double>::infinity();
  approach.nearest = squared_nearest;
  Eigen::AlignedBox3d box;
  ContactSet contacts;
  Pose before = pose_at(0);
  for (long k = 0; double(k) * kLookEvery <= duration; ++k) {
    const double time = double(k) * kLookEvery;
    const Pose pose = pose_at(time);
    box.extend(pose.position);
    approach.fastest =
        std::max(approach.fastest, (pose.position - before.position).norm() / kLookEvery);
    for (const auto& tree : trees) {
      const auto nearer = tree.nearest_within(pose.position, squared_nearest);
      if (!nearer) continue;
      squared_nearest = nearer->squared_distance;
      approach.nearest = std::sqrt(squared_nearest);
      approach.nearest_at = time;
    }
    if (!approach.touches_at && !approach.begins_inside) {
      contacts.clear();
      contacts.probe_pose = pose;
      const SearchReport found = finder.find(0, {before, pose}, kMargin, kEnough, contacts);
      approach.begins_inside = k == 0 && found.begun_inside;
      if (touches(contacts)) approach.touches_at = time;
    }
    before = pose;
  }
  approach.extent = box.sizes().maxCoeff();
  return approach;
}

}  // namespace palpate::collision
