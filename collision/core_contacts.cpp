#include "collision/core_contacts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "modules/core/tolerances.h"

namespace palpate::collision {
namespace {

/// A triangle belongs to the wall a core is behind if its normal is within 78° of the wall's.
constexpr double kSameWall = 0.2;

double side(const SweptTriangle& triangle, const geometry::SegmentAndTriangle& pair) {
  return triangle.normal_end.dot(pair.on_segment - triangle.end[0]);
}

struct Candidate {
  const SweptTriangle& triangle;
  geometry::SegmentAndTriangle pair;  ///< at the end
  double side = 0;                    ///< of the core at the end, > 0 in front [m]
  std::optional<Crossing> crossing;
  bool remembered = false;
  bool on_wall = false;  ///< connected with what the core is behind

  double gap(const Core& core) const { return pair.distance - core.radius; }
  FoundContact contact(const OrganStep& step, const Core& core) const {
    FoundContact result;
    result.organ = step.organ_index;
    result.triangle = triangle.index;
    result.barycentric = pair.on_triangle.weights;
    const bool may_touch = gap(core) < triangle.travel + core.radius * 1e-6;
    result.time_of_impact = may_touch ? time_of_touch(core, triangle) : 1;
    return result;
  }
};

Vec3 at_weights(const geometry::TriangleCorners& triangle, const Vec3& weights) {
  return weights[0] * triangle[0] + weights[1] * triangle[1] + weights[2] * triangle[2];
}

double height_over(const geometry::TriangleCorners& triangle, const Vec3& p) {
  return geometry::unit_normal(triangle).dot(p - triangle[0]);
}

/// Did the core go from the front of the triangle through it? What counts is the point of the core
/// that met it: another part of a segment may be anywhere.
std::optional<Crossing> crossed_inward(const OrganStep& step, const Core& core,
                                       const SweptTriangle& triangle, double distance_end) {
  const double separation = step.motion.chord_error();
  if (distance_end > triangle.travel + separation) return {};
  if (core.is_point() && !(height_over(triangle.end, core.a) <= 0)) return {};
  if (core.is_point() && !(height_over(triangle.start, core.a) > 0)) return {};
  auto crossing = first_crossing(core, triangle, separation);
  if (!crossing || core.is_point()) return crossing;
  const bool is_inward = height_over(triangle.start, crossing->on_core) > 0 &&
                         height_over(triangle.end, crossing->on_core) <= 0;
  if (!is_inward) crossing.reset();
  return crossing;
}

/// Core in front of the triangle at the end.
void append_front(const OrganStep& step, const Core& core, const Candidate& candidate,
                  std::vector<FoundContact>& found) {
  FoundContact contact = candidate.contact(step, core);
  const geometry::SegmentAndTriangle& pair = candidate.pair;
  contact.normal_P = pair.distance > kDirectionless
                         ? Vec3((pair.on_segment - pair.on_triangle.point) / pair.distance)
                         : candidate.triangle.normal_end;
  contact.point_P = pair.on_segment - core.radius * contact.normal_P;
  contact.gap = contact.normal_P.dot(contact.point_P - pair.on_triangle.point);
  append_contact(contact, candidate.triangle.nodes, found);
}

/// Contact of the closest approach, carried to the end, for a triangle touched in passing that is
/// now neither in front within the margin nor crossed.
void append_graze(const OrganStep& step, const Core& core, const Candidate& candidate,
                  std::vector<FoundContact>& found) {
  const SweptTriangle& triangle = candidate.triangle;
  if (candidate.gap(core) > triangle.travel) return;
  const double touch = time_of_touch(core, triangle);
  if (touch >= 1) return;
  const ClosestApproach nearest = closest_approach(core, triangle, touch);
  if (nearest.pair.distance >= core.radius || nearest.pair.distance < kDirectionless) return;
  const Vec3 apart = nearest.pair.on_segment - nearest.pair.on_triangle.point;
  if (apart.dot(geometry::unit_normal(triangle.at(nearest.time))) <= 0) return;
  FoundContact contact = candidate.contact(step, core);
  contact.normal_P = apart / nearest.pair.distance;
  contact.barycentric = nearest.pair.on_triangle.weights;
  contact.point_P = nearest.pair.on_segment - core.radius * contact.normal_P;
  const Vec3 tissue = at_weights(triangle.end, contact.barycentric);
  contact.gap = contact.normal_P.dot(contact.point_P - tissue);
  if (contact.gap <= step.margin) append_contact(contact, triangle.nodes, found);
}

/// Depth of the rounded core below q, measured against n on the line through q along n, where it is
/// nearest; 1 if that line misses it.
double reach_below(const Core& core, const Vec3& nearest, const Vec3& q, const Vec3& n) {
  const double height = n.dot(nearest - q);
  const double sideways_squared = (nearest - q - height * n).squaredNorm();
  const double half_squared = core.radius * core.radius - sideways_squared;
  return half_squared > 0 ? height - std::sqrt(half_squared) : 1;
}

/// Contact of a core behind the triangle, which pushes it out along the outward normal.
/// @param depth_limit  a wall crossed deeper than this is given up [m]
/// @param nearest_of_wall  the core gets this contact even if the triangle is not straight above
bool append_behind(const OrganStep& step, const Core& core, const Candidate& candidate,
                   double depth_limit, bool nearest_of_wall, std::vector<FoundContact>& found) {
  const SweptTriangle& triangle = candidate.triangle;
  const geometry::SegmentAndTriangle& pair = candidate.pair;
  FoundContact contact = candidate.contact(step, core);
  contact.normal_P = triangle.normal_end;
  contact.gap = reach_below(core, pair.on_segment, pair.on_triangle.point, contact.normal_P);
  if (contact.gap > 0 && nearest_of_wall) {
    const Vec3 outward = pair.on_triangle.point - pair.on_segment;
    if (outward.dot(contact.normal_P) > kSameWall * pair.distance)
      contact.normal_P = outward.normalized();
    contact.gap = -pair.distance - core.radius;
  }
  if (contact.gap > 0 || -contact.gap > depth_limit) return false;
  contact.point_P = pair.on_triangle.point + contact.gap * contact.normal_P;
  append_contact(contact, triangle.nodes, found);
  return true;
}

/// Contact of the crossing itself, for a core that is already off to the side or deep.
void append_crossed(const OrganStep& step, const Core& core, const Candidate& candidate,
                    std::vector<FoundContact>& found) {
  FoundContact contact = candidate.contact(step, core);
  contact.barycentric = candidate.crossing->weights;
  contact.normal_P = candidate.triangle.normal_end;
  contact.point_P = candidate.crossing->on_core - core.radius * contact.normal_P;
  const Vec3 tissue = at_weights(candidate.triangle.end, contact.barycentric);
  contact.gap = contact.normal_P.dot(contact.point_P - tissue);
  append_contact(contact, candidate.triangle.nodes, found);
}

/// Marks the triangles connected with the crossed and remembered ones over nodes shared by
/// triangles that face like the wall.
void mark_wall(std::vector<Candidate>& candidates) {
  Vec3 outward = Vec3::Zero();
  std::vector<std::uint32_t> nodes;
  const auto add = [&](Candidate& c) {
    c.on_wall = true;
    nodes.insert(nodes.end(), c.triangle.nodes.begin(), c.triangle.nodes.end());
  };
  for (Candidate& c : candidates) {
    if (!c.crossing && !c.remembered) continue;
    outward += c.triangle.normal_end;
    add(c);
  }
  const double limit = kSameWall * outward.norm();
  for (std::size_t before = 0; before != nodes.size();) {
    before = nodes.size();
    std::sort(nodes.begin(), nodes.end());
    const auto known = nodes;
    for (Candidate& c : candidates) {
      if (c.on_wall || !(c.triangle.normal_end.dot(outward) > limit)) continue;
      const auto is_known = [&](std::uint32_t node) {
        return std::binary_search(known.begin(), known.end(), node);
      };
      if (std::any_of(c.triangle.nodes.begin(), c.triangle.nodes.end(), is_known)) add(c);
    }
  }
}

/// Contacts of a core that is behind the wall. @returns the triangles it is behind now
std::vector<std::uint32_t> append_wall(const OrganStep& step, const Core& core, double depth_limit,
                                       std::vector<Candidate>& candidates,
                                       std::vector<FoundContact>& found) {
  mark_wall(candidates);
  const Candidate* nearest = nullptr;
  for (const Candidate& c : candidates) {
    if (!c.on_wall || c.side > 0) continue;
    if (nearest == nullptr || c.pair.distance < nearest->pair.distance) nearest = &c;
  }
  std::vector<std::uint32_t> behind;
  for (const Candidate& c : candidates) {
    if (!c.on_wall) continue;
    if (c.side > 0 && !c.crossing) {
      if (c.gap(core) <= step.margin) append_front(step, core, c, found);
      continue;
    }
    bool is_behind = c.side <= 0 && append_behind(step, core, c, depth_limit, &c == nearest, found);
    if (!is_behind && c.crossing) {
      append_crossed(step, core, c, found);
      is_behind = true;
    }
    if (is_behind) behind.push_back(c.triangle.index);
  }
  return behind;
}

/// Whether a core remembered to be behind a wall has left the organ by another way or lies beyond
/// the wall's edge. It has if every nearest triangle faces it and none faces against the wall, as
/// the far side of an organ does once it has been passed through.
bool is_out(const std::vector<Candidate>& candidates) {
  double nearest = std::numeric_limits<double>::infinity();
  Vec3 outward = Vec3::Zero();
  for (const Candidate& c : candidates) {
    nearest = std::min(nearest, c.pair.distance);
    if (c.remembered) outward += c.triangle.normal_end;
  }
  if (nearest <= kDirectionless) return false;
  return std::none_of(candidates.begin(), candidates.end(), [&](const Candidate& c) {
    const bool is_nearest = c.pair.distance <= nearest + kDirectionless;
    const bool faces_against = c.triangle.normal_end.dot(outward) < -kSameWall * outward.norm();
    return is_nearest && (c.side <= 0 || faces_against);
  });
}

}  // namespace

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

void CoreContacts::append_remembered(std::uint32_t organ, std::vector<std::uint32_t>& triangles,
                                     double& depth_limit) const {
  for (const Behind& b : before_) {
    if (b.organ != organ) continue;
    triangles.push_back(b.triangle);
    depth_limit = std::max(depth_limit, b.depth_limit);
  }
}

void CoreContacts::append_remembered(std::uint32_t organ, std::uint32_t core,
                                     std::vector<std::uint32_t>& triangles) const {
  for (const Behind& b : remembered(organ, core)) triangles.push_back(b.triangle);
}

void CoreContacts::find(const OrganStep& step, const Core& core,
                        std::span<const SweptTriangle> candidates,
                        std::vector<FoundContact>& found) {
  const auto before = remembered(step.organ_index, core.index);
  double depth_limit = 0;
  for (const Behind& b : before) depth_limit = std::max(depth_limit, b.depth_limit);
  std::vector<Candidate> near;
  bool crosses = false;
  for (const SweptTriangle& triangle : candidates) {
    Candidate c{triangle, closest(core, triangle.end), 0, {}, false, false};
    if (before.empty() && c.gap(core) > std::max(step.margin, triangle.travel)) continue;
    c.side = side(triangle, c.pair);
    c.remembered = std::any_of(before.begin(), before.end(),
                               [&](const Behind& b) { return b.triangle == triangle.index; });
    c.crossing = crossed_inward(step, core, triangle, c.pair.distance);
    if (c.crossing) depth_limit = std::max(depth_limit, step.depth_limit);
    crosses = crosses || c.crossing;
    near.push_back(c);
  }
  if (crosses || (!before.empty() && !is_out(near))) {
    for (const std::uint32_t triangle : append_wall(step, core, depth_limit, near, found)) {
      now_.push_back({step.organ_index, core.index, triangle, depth_limit});
    }
    return;
  }
  for (const Candidate& c : near) {
    if (c.side > 0 && c.gap(core) <= step.margin) {
      append_front(step, core, c, found);
    } else if (before.empty()) {  // a core that has just left touched walls from behind
      append_graze(step, core, c, found);
    }
  }
}

}  // namespace palpate::collision
