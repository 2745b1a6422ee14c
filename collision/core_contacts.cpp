#include "collision/core_contacts.h"

#include <algorithm>
#include <limits>
#include <tuple>
#include <utility>

#include "modules/core/error.h"
#include "modules/core/tolerances.h"

namespace palpate::collision {

void CoreContacts::reset() {
  before_.clear();
  now_.clear();
}

void CoreContacts::begin_step() {
  before_.swap(now_);
  now_.clear();
  std::sort(before_.begin(), before_.end(), [](const Behind& a, const Behind& b) {
    return std::tie(a.organ, a.core, a.triangle) < std::tie(b.organ, b.core, b.triangle);
  });
}

std::span<const CoreContacts::Behind> CoreContacts::remembered(std::uint32_t organ,
                                                               std::uint32_t core) const {
  const auto [first, last] =
      std::equal_range(before_.begin(), before_.end(), Behind{organ, core, 0, 0},
                       [](const Behind& a, const Behind& b) {
                         return std::tie(a.organ, a.core) < std::tie(b.organ, b.core);
                       });
  return {first, last};
}

void CoreContacts::append_held(std::uint32_t organ, std::vector<std::uint32_t>& cores) const {
  for (const Behind& b : before_) {
    if (b.organ == organ && (cores.empty() || cores.back() != b.core)) cores.push_back(b.core);
  }
}

/// Whether an end of the core is; a segment with both ends outside is behind no wall, whatever it
/// pierces: its ends are cores of their own.
bool CoreContacts::is_inside(const OrganStep& step, const Core& core) {
  return surface_.encloses(step.organ, step.motion.to_world_at_end(core.a)) ||
         (!core.is_point() && surface_.encloses(step.organ, step.motion.to_world_at_end(core.b)));
}

bool CoreContacts::hold_if_inside(const OrganStep& step, const Core& core) {
  if (!remembered(step.organ_index, core.index).empty() || !is_inside(step, core)) return false;
  double distance = 0;
  const Vec3 a = step.motion.to_world_at_end(core.a), b = step.motion.to_world_at_end(core.b);
  const Vec3& inside = surface_.encloses(step.organ, a) ? a : b;
  const std::uint32_t triangle = surface_.nearest_triangle(step.organ, inside, distance);
  const auto later = [&](const Behind& held) {
    return std::pair(held.organ, held.core) > std::pair(step.organ_index, core.index);
  };
  before_.insert(std::find_if(before_.begin(), before_.end(), later),
                 {step.organ_index, core.index, triangle, step.depth_limit});
  return true;
}

void CoreContacts::append_near_wall(const OrganStep& step, const Core& core,
                                    std::vector<std::uint32_t>& triangles) {
  const auto before = remembered(step.organ_index, core.index);
  if (before.empty()) return;
  const auto distance = [&](std::uint32_t t) {
    const geometry::Triangle& nodes = step.organ.triangles()[t];
    return closest(core,
                   {step.node_end(nodes[0]), step.node_end(nodes[1]), step.node_end(nodes[2])})
        .distance;
  };
  // What is as near as the nearest of what it was behind, and within the radius around that.
  double reach = std::numeric_limits<double>::infinity();
  for (const Behind& b : before) reach = std::min(reach, distance(b.triangle));
  reach += core.radius + step.margin;
  seen_.assign(step.organ.triangles().size(), 0);
  waiting_.clear();
  for (const Behind& b : before) {
    waiting_.push_back(b.triangle);
    seen_[b.triangle] = 1;
  }
  while (!waiting_.empty()) {
    const std::uint32_t triangle = waiting_.back();
    waiting_.pop_back();
    triangles.push_back(triangle);
    for (const std::uint32_t node : step.organ.triangles()[triangle]) {
      for (const std::uint32_t t : step.organ.triangles_of_node(node)) {
        if (std::exchange(seen_[t], 1) == 0 && distance(t) <= reach) waiting_.push_back(t);
      }
    }
  }
}

/// Whether a core that was behind a wall and is outside has come out where it may stay: not through
/// the far side, which faces against the wall.
bool CoreContacts::has_left(const OrganStep& step, const Core& core,
                            std::span<const Behind> before) {
  Vec3 outward = Vec3::Zero();
  SweptTriangle triangle;
  for (const Behind& b : before) {
    if (step.sweep(b.triangle, triangle)) outward += triangle.normal_end;
  }
  double distance = 0;
  surface_.nearest_triangle(step.organ, step.motion.to_world_at_end(core.a), distance);
  Bounds box;
  box.add(step.motion.to_world_at_end(core.a));
  box.inflate(distance + kDirectionless);
  waiting_.clear();
  step.organ.bvh().append_overlapping(box, waiting_);
  return std::none_of(waiting_.begin(), waiting_.end(), [&](std::uint32_t t) {
    return step.sweep(t, triangle) &&
           triangle.normal_end.dot(outward) < -kSameWall * outward.norm() &&
           closest({0, core.a, core.a, 0}, triangle.end).distance <= distance + kDirectionless;
  });
}

/// Contact with the wall nearest to a core that is inside. @returns its triangle
std::uint32_t CoreContacts::hold_nearest(const OrganStep& step, const Core& core,
                                         std::vector<FoundContact>& found) {
  const Vec3& end =
      surface_.encloses(step.organ, step.motion.to_world_at_end(core.a)) ? core.a : core.b;
  double distance = 0;
  const std::uint32_t nearest =
      surface_.nearest_triangle(step.organ, step.motion.to_world_at_end(end), distance);
  SweptTriangle triangle;
  PALPATE_DEMAND(step.sweep(nearest, triangle));
  const Core point{core.index, end, end, core.radius};
  append_nearest(step, point, CoreCandidate(point, triangle), found);
  return nearest;
}

void CoreContacts::find(const OrganStep& step, const Core& core,
                        std::span<const SweptTriangle> candidates,
                        std::vector<FoundContact>& found) {
  const auto before = remembered(step.organ_index, core.index);
  double depth_limit = 0;
  for (const Behind& b : before) depth_limit = std::max(depth_limit, b.depth_limit);
  std::vector<CoreCandidate> near;
  bool crosses = false;
  for (const SweptTriangle& triangle : candidates) {
    CoreCandidate c(core, triangle);
    if (before.empty() && c.gap(core) > std::max(step.margin, triangle.travel)) continue;
    c.remembered = std::any_of(before.begin(), before.end(),
                               [&](const Behind& b) { return b.triangle == triangle.index; });
    c.crossing = crossed_inward(step, core, c);
    if (c.crossing) depth_limit = std::max(depth_limit, step.depth_limit);
    crosses = crosses || c.crossing;
    near.push_back(c);
  }
  const bool was_behind = !before.empty();
  const bool inside = (crosses || was_behind) && is_inside(step, core);
  if (crosses || inside || (was_behind && !has_left(step, core, before))) {
    find_behind(step, core, inside, depth_limit, near, found);
    return;
  }
  for (const CoreCandidate& c : near) {
    if (c.side > 0 && c.gap(core) <= step.margin) {
      append_front(step, core, c, found);
    } else if (!was_behind) {  // a core that has just left touched walls from behind
      append_graze(step, core, c, found);
    }
  }
}

/// Contacts of a core that is behind a wall, which is remembered.
void CoreContacts::find_behind(const OrganStep& step, const Core& core, bool inside,
                               double depth_limit, std::vector<CoreCandidate>& near,
                               std::vector<FoundContact>& found) {
  const std::size_t others = found.size();
  constexpr double kUnlimited = std::numeric_limits<double>::infinity();
  auto wall = append_wall(step, core, inside ? kUnlimited : depth_limit, near, found);
  if (inside && wall.empty()) wall.push_back(hold_nearest(step, core, found));
  if (inside) {  // from here it may be dragged back through a far side
    for (std::size_t i = others; i < found.size(); ++i) {
      depth_limit = std::max({depth_limit, step.depth_limit, step.motion.travel() - found[i].gap});
    }
  }
  for (const std::uint32_t triangle : wall) {
    now_.push_back({step.organ_index, core.index, triangle, depth_limit});
  }
}

}  // namespace palpate::collision
