#include "collision/core_contacts.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <tuple>
#include <utility>

#include "modules/core/error.h"
#include "modules/core/tolerances.h"

namespace palpate::collision {
namespace {

double distance_to(const OrganStep& step, const Core& core, std::uint32_t triangle) {
  const geometry::Triangle& nodes = step.organ.triangles()[triangle];
  return closest(core, {step.node_end(nodes[0]), step.node_end(nodes[1]), step.node_end(nodes[2])})
      .distance;
}

/// How far around the foot of a segment so many triangles of this size lie on a flat wall: the disc
/// about a point, a strip with round ends under a segment.
double spread_of(double triangles, double area, double length) {
  return (std::sqrt(length * length + M_PI * triangles * area) - length) / M_PI;
}

double area_of(const OrganStep& step, std::uint32_t triangle) {
  const auto [a, b, c] = step.organ.corners(triangle);
  return (b - a).cross(c - a).norm() / 2;
}

}  // namespace

void CoreContacts::reset() {
  before_.clear();
  now_.clear();
}

void CoreContacts::change_surface(const SurfaceChange& change) {
  for (Behind& behind : now_) {
    if (behind.organ == change.organ) behind.triangle = change.triangle(behind.triangle);
  }
}

void CoreContacts::begin_step() {
  before_.swap(now_);
  now_.clear();
  wall_was_cut_ = false;
  std::sort(before_.begin(), before_.end(), [](const Behind& a, const Behind& b) {
    return std::tie(a.organ, a.core, a.triangle) < std::tie(b.organ, b.core, b.triangle);
  });
}

std::span<const CoreContacts::Behind> CoreContacts::remembered(std::uint32_t organ,
                                                               std::uint32_t core) const {
  const auto [first, last] =
      std::equal_range(before_.begin(), before_.end(), Behind{organ, core, 0, 0, 0},
                       [](const Behind& a, const Behind& b) {
                         return std::tie(a.organ, a.core) < std::tie(b.organ, b.core);
                       });
  return {first, last};
}

const CoreContacts::Behind& CoreContacts::nearest_of(std::span<const Behind> before) {
  return *std::min_element(before.begin(), before.end(), [](const Behind& a, const Behind& b) {
    return a.distance < b.distance;
  });
}

void CoreContacts::append_held(std::uint32_t organ, std::vector<std::uint32_t>& cores) const {
  for (const Behind& b : before_) {
    if (b.organ == organ && (cores.empty() || cores.back() != b.core)) cores.push_back(b.core);
  }
}

/// What is between a segment's ends may be inside though they are not: a rod that comes out of a
/// dent it made, or that a ridge has swung over.
std::optional<Vec3> CoreContacts::place_inside(const OrganStep& step, const Core& core) {
  const auto at = surface_.encloses_at(step.organ, step.motion.to_world_at_end(core.a),
                                       step.motion.to_world_at_end(core.b));
  if (!at) return {};
  return (1 - *at) * core.a + *at * core.b;
}

bool CoreContacts::hold_if_inside(const OrganStep& step, const Core& core) {
  if (!remembered(step.organ_index, core.index).empty()) return false;
  const auto inside = place_inside(step, core);
  if (!inside) return false;
  double distance = 0;
  const std::uint32_t triangle =
      surface_.nearest_triangle(step.organ, step.motion.to_world_at_end(*inside), distance);
  const auto later = [&](const Behind& held) {
    return std::pair(held.organ, held.core) > std::pair(step.organ_index, core.index);
  };
  before_.insert(std::find_if(before_.begin(), before_.end(), later),
                 {step.organ_index, core.index, triangle, step.depth_limit, distance});
  return true;
}

double CoreContacts::wall_reach(const OrganStep& step, const Core& core) {
  const auto before = remembered(step.organ_index, core.index);
  if (before.empty()) return 0;
  // The wall's nearest place is no further than what was nearest last.
  const double distance = distance_to(step, core, nearest_of(before).triangle);
  double area = 0;
  for (const Behind& b : before) area += area_of(step, b.triangle) / double(before.size());
  const double near =
      std::hypot(distance, spread_of(kWallTriangles, area, (core.b - core.a).norm()));
  const double all = distance + core.radius + step.margin;
  wall_was_cut_ |= near < all;
  return std::min(near, all);
}

void CoreContacts::append_remembered(const OrganStep& step, const Core& core,
                                     std::vector<std::uint32_t>& triangles) const {
  const auto before = remembered(step.organ_index, core.index);
  if (wall_was_cut_ && !before.empty()) return triangles.push_back(nearest_of(before).triangle);
  for (const Behind& b : before) triangles.push_back(b.triangle);
}

void CoreContacts::append_near_wall(const OrganStep& step, const Core& core, std::size_t most,
                                    std::vector<std::uint32_t>& triangles) {
  const auto before = remembered(step.organ_index, core.index);
  if (before.empty()) return;
  const double reach = wall_reach(step, core);
  const std::size_t first = triangles.size();
  marks_.begin();
  by_distance_.clear();
  const auto add = [&](std::uint32_t triangle, double distance) {
    by_distance_.push_back({distance, triangle});
    std::ranges::push_heap(by_distance_, std::greater());
  };
  waiting_.clear();
  append_remembered(step, core, waiting_);
  for (const std::uint32_t triangle : waiting_) {
    if (marks_.add(triangle, 0) == IndexMarks::kNone) {
      add(triangle, distance_to(step, core, triangle));
    }
  }
  while (!by_distance_.empty() && triangles.size() - first < most) {
    const std::uint32_t triangle = by_distance_.front().second;
    std::ranges::pop_heap(by_distance_, std::greater());
    by_distance_.pop_back();
    triangles.push_back(triangle);
    for (const std::uint32_t node : step.organ.triangles()[triangle]) {
      for (const std::uint32_t t : step.organ.triangles_of_node(node)) {
        if (marks_.add(t, 0) != IndexMarks::kNone) continue;
        const double distance = distance_to(step, core, t);
        if (distance <= reach) add(t, distance);
      }
    }
  }
  wall_was_cut_ |= !by_distance_.empty();
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
  step.organ.append_overlapping(box, waiting_);
  return std::none_of(waiting_.begin(), waiting_.end(), [&](std::uint32_t t) {
    return step.sweep(t, triangle) &&
           triangle.normal_end.dot(outward) < -kSameWall * outward.norm() &&
           closest({0, core.a, core.a, 0}, triangle.end).distance <= distance + kDirectionless;
  });
}

/// Contact with the wall nearest to what of a core is inside.
void CoreContacts::append_nearest_wall(const OrganStep& step, const Core& core, const Vec3& inside,
                                       std::vector<FoundContact>& found) {
  double distance = 0;
  const std::uint32_t nearest =
      surface_.nearest_triangle(step.organ, step.motion.to_world_at_end(inside), distance);
  SweptTriangle triangle;
  PALPATE_DEMAND(step.sweep(nearest, triangle));
  const Core point{core.index, inside, inside, core.radius};
  append_nearest(step, point, CoreCandidate(point, triangle), found);
}

void CoreContacts::find(const OrganStep& step, const Core& core,
                        std::span<const SweptTriangle> candidates,
                        std::vector<FoundContact>& found) {
  const auto before = remembered(step.organ_index, core.index);
  double depth_limit = 0;
  for (const Behind& b : before) depth_limit = std::max(depth_limit, b.depth_limit);
  near_.clear();
  bool crosses = false;
  for (const SweptTriangle& triangle : candidates) {
    CoreCandidate& c = near_.emplace_back(core, triangle);
    if (before.empty() && c.gap(core) > std::max(step.margin, triangle.travel)) {
      near_.pop_back();
      continue;
    }
    c.remembered = std::binary_search(
        before.begin(), before.end(), Behind{0, 0, triangle.index, 0, 0},
        [](const Behind& a, const Behind& b) { return a.triangle < b.triangle; });
    c.crossing = crossed_inward(step, core, c);
    if (c.crossing) depth_limit = std::max(depth_limit, step.depth_limit);
    crosses = crosses || c.crossing;
  }
  const bool was_behind = !before.empty();
  const auto inside = crosses || was_behind ? place_inside(step, core) : std::nullopt;
  if (crosses || inside || (was_behind && !has_left(step, core, before))) {
    find_behind(step, core, inside, depth_limit, found);
    return;
  }
  places_.begin();
  for (const CoreCandidate& c : near_) {
    if (c.side > 0 && c.gap(core) <= step.margin) {
      if (!is_new_place(core, c)) continue;
      append_front(step, core, c.pair, c.triangle.index, c.triangle.nodes, c.triangle.normal_end,
                   found);
    } else if (!was_behind) {  // a core that has just left touched walls from behind
      append_graze(step, core, c, found);
    }
  }
}

/// Whether no triangle before had its closest point on the same node or edge: the contact would be
/// the same but for rounding.
bool CoreContacts::is_new_place(const Core& core, const CoreCandidate& c) {
  if (!core.is_point() || c.pair.distance < kSteadyDistance) return true;
  const auto place = node_or_edge(c.pair.on_triangle.weights, c.triangle.nodes);
  return !place || places_.add(*place, 0) == IndexMarks::kNone;
}

/// Contacts of a core that is behind a wall, which is remembered.
void CoreContacts::find_behind(const OrganStep& step, const Core& core,
                               const std::optional<Vec3>& inside, double depth_limit,
                               std::vector<FoundContact>& found) {
  const std::size_t others = found.size();
  wall_.clear();
  append_wall(step, core, inside ? kInside : depth_limit, near_, wall_buffers_, wall_, found);
  if (inside && wall_.empty()) append_nearest_wall(step, core, *inside, found);
  if (inside) {  // from here it may be dragged back through a far side
    for (std::size_t i = others; i < found.size(); ++i) {
      depth_limit = std::max({depth_limit, step.depth_limit, step.motion.travel() - found[i].gap});
    }
  }
  if (inside && wall_.empty()) {
    now_.push_back({step.organ_index, core.index, found.back().triangle, depth_limit, 0});
  }
  for (const CoreCandidate* c : wall_) {
    now_.push_back(
        {step.organ_index, core.index, c->triangle.index, depth_limit, c->pair.distance});
  }
}

}  // namespace palpate::collision
