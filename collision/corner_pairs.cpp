#include "collision/corner_pairs.h"

#include <algorithm>

#include "modules/geometry/continuous_collision.h"

namespace palpate::collision {

void CornerPairs::hold(const OrganStep& step, const ProbeModel& probe, CoreContacts& cores,
                       std::vector<std::uint32_t>& triangles) {
  held_.clear();
  wall_pairs_.clear();
  cores.append_held(step.organ_index, held_);
  if (held_.empty()) return;
  const std::size_t of_each = std::max(kLeastWall, kManyWallPairs / held_.size());
  for (const std::uint32_t corner : held_) {
    const std::size_t first = triangles.size();
    cores.append_near_wall(step, probe.core(corner), of_each, triangles);
    for (std::size_t i = first; i < triangles.size(); ++i) {
      wall_pairs_.push_back({corner, triangles[i]});
    }
  }
}

bool CornerPairs::are_too_many(const OrganStep& step, const ProbeModel& probe,
                               std::span<const SweptTriangle> triangles) {
  return probe.sharp->vertices().size() > kFewCorners &&
         kFewestOfEach * triangles.size() > kManyPairs && !list_near(step, *probe.sharp, triangles);
}

void CornerPairs::list(const OrganStep& step, const ProbeModel& probe,
                       std::span<const SweptTriangle> triangles) {
  was_cut_ = false;
  if (!list_near(step, *probe.sharp, triangles)) list_nearest(step, *probe.sharp, triangles);
  add_walls(triangles);
  sorter_.sort_unique(pairs_, probe.sharp->vertices().size() + probe.lines.size());
}

/// @returns whether they are no more than kManyPairs, and listed
bool CornerPairs::list_near(const OrganStep& step, const SharpMesh& probe,
                            std::span<const SweptTriangle> triangles) {
  pairs_.clear();
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    add_near(step, probe, triangles[i], step.margin, i);
    if (pairs_.size() > kManyPairs) return false;
  }
  return true;
}

/// @returns of how many corners
std::size_t CornerPairs::add_near(const OrganStep& step, const SharpMesh& probe,
                                  const SweptTriangle& triangle, double beside,
                                  std::uint32_t place) {
  Bounds box = triangle.bounds();
  box.inflate(beside + step.motion.chord_error());
  near_.clear();
  probe.append_vertices(box, near_);
  for (const std::uint32_t corner : near_) pairs_.push_back({corner, place});
  return near_.size();
}

void CornerPairs::list_nearest(const OrganStep& step, const SharpMesh& probe,
                               std::span<const SweptTriangle> triangles) {
  const std::size_t of_each = std::max(kFewestOfEach, kManyPairs / triangles.size());
  std::size_t passed = 0;
  pairs_.clear();
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    if (passed <= kMostPassed) {
      passed += add_near(step, probe, triangles[i], geometry::kImpactTolerance, i);
    }
    near_.clear();
    probe.append_nearest_vertices(triangles[i].end, step.margin, of_each, near_);
    for (const std::uint32_t corner : near_) pairs_.push_back({corner, i});
  }
  was_cut_ = passed > kMostPassed;
}

void CornerPairs::add_walls(std::span<const SweptTriangle> triangles) {
  for (const auto& [corner, index] : wall_pairs_) {
    const auto at = std::ranges::lower_bound(triangles, index, {}, &SweptTriangle::index);
    if (at != triangles.end() && at->index == index) {
      pairs_.push_back({corner, static_cast<std::uint32_t>(at - triangles.begin())});
    }
  }
}

}  // namespace palpate::collision
