#include "collision/core_wall.h"

#include <algorithm>
#include <cmath>

#include "modules/core/tolerances.h"

namespace palpate::collision {
namespace {

Vec3 at_weights(const geometry::TriangleCorners& triangle, const Vec3& weights) {
  return weights[0] * triangle[0] + weights[1] * triangle[1] + weights[2] * triangle[2];
}

double height_over(const geometry::TriangleCorners& triangle, const Vec3& p) {
  return geometry::unit_normal(triangle).dot(p - triangle[0]);
}

FoundContact contact_of(const OrganStep& step, std::uint32_t triangle, const Vec3& weights) {
  FoundContact result;
  result.organ = step.organ_index;
  result.triangle = triangle;
  result.barycentric = weights;
  return result;
}
FoundContact contact_of(const OrganStep& step, const CoreCandidate& candidate) {
  return contact_of(step, candidate.triangle.index, candidate.pair.on_triangle.weights);
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
bool append_behind(const OrganStep& step, const Core& core, const CoreCandidate& candidate,
                   double depth_limit, bool nearest_of_wall, std::vector<FoundContact>& found) {
  const SweptTriangle& triangle = candidate.triangle;
  const geometry::SegmentAndTriangle& pair = candidate.pair;
  FoundContact contact = contact_of(step, candidate);
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
void append_crossed(const OrganStep& step, const Core& core, const CoreCandidate& candidate,
                    std::vector<FoundContact>& found) {
  FoundContact contact = contact_of(step, candidate);
  contact.barycentric = candidate.crossing->weights;
  contact.normal_P = candidate.triangle.normal_end;
  contact.point_P = candidate.crossing->on_core - core.radius * contact.normal_P;
  const Vec3 tissue = at_weights(candidate.triangle.end, contact.barycentric);
  contact.gap = contact.normal_P.dot(contact.point_P - tissue);
  append_contact(contact, candidate.triangle.nodes, found);
}

/// Marks the triangles connected with the crossed and remembered ones over nodes shared by
/// triangles that face like the wall.
/// @param candidates  ascending
void mark_wall(const OrganSurface& organ, std::vector<CoreCandidate>& candidates,
               WallBuffers& buffers) {
  Vec3 outward = Vec3::Zero();
  auto& [places, seen_nodes, waiting] = buffers;
  waiting.clear();
  places.begin();
  seen_nodes.begin();
  for (CoreCandidate& c : candidates) {
    places.set(c.triangle.index, static_cast<std::uint32_t>(&c - candidates.data()));
    if (!c.crossing && !c.remembered) continue;
    outward += c.triangle.normal_end;
    c.on_wall = true;
    waiting.push_back(&c);
  }
  const double limit = kSameWall * outward.norm();
  const auto visit = [&](std::uint32_t triangle) {
    const std::uint32_t place = places.at(triangle);
    if (place == IndexMarks::kNone) return;
    CoreCandidate& c = candidates[place];
    if (c.on_wall || !(c.triangle.normal_end.dot(outward) > limit)) return;
    c.on_wall = true;
    waiting.push_back(&c);
  };
  while (!waiting.empty()) {
    const geometry::Triangle& nodes = waiting.back()->triangle.nodes;
    waiting.pop_back();
    for (const std::uint32_t node : nodes) {
      if (seen_nodes.add(node, 0) != IndexMarks::kNone) continue;
      for (const std::uint32_t t : organ.triangles_of_node(node)) visit(t);
    }
  }
}

/// What a point inside is behind where its wall ends: in the corner of a dent it comes out of one
/// side of that, and is behind the other, which does not face like it. Far triangles of the first
/// that it is behind, too, are folded away from it.
/// @returns the nearest; null: it is behind the wall that is marked
const CoreCandidate* behind_beside(std::span<const CoreCandidate> candidates) {
  const CoreCandidate *of_wall = nullptr, *behind = nullptr;
  const auto nearer = [](const CoreCandidate& c, const CoreCandidate* than) {
    return than == nullptr || c.pair.distance < than->pair.distance;
  };
  for (const CoreCandidate& c : candidates) {
    if (c.on_wall && nearer(c, of_wall)) of_wall = &c;
    if (c.side <= 0 && nearer(c, behind)) behind = &c;
  }
  if (of_wall == nullptr || of_wall->side <= 0 || behind == nullptr || behind->on_wall) return {};
  return behind->pair.distance <= of_wall->pair.distance ? behind : nullptr;
}

}  // namespace

CoreCandidate::CoreCandidate(const Core& core, const SweptTriangle& swept)
    : triangle(swept),
      pair(closest(core, swept.end)),
      side(swept.normal_end.dot(pair.on_segment - swept.end[0])) {}

std::optional<Crossing> crossed_inward(const OrganStep& step, const Core& core,
                                       const CoreCandidate& candidate) {
  const SweptTriangle& triangle = candidate.triangle;
  const double separation = step.motion.chord_error();
  if (candidate.pair.distance > triangle.travel + separation) return {};
  if (core.is_point() && !(height_over(triangle.end, core.a) <= 0)) return {};
  if (core.is_point() && !(height_over(triangle.start, core.a) > 0)) return {};
  auto crossing = first_crossing(core, triangle, separation);
  if (!crossing || core.is_point()) return crossing;
  // What counts is the point that met it: another part of a segment may be anywhere.
  const bool is_inward = height_over(triangle.start, crossing->on_core) > 0 &&
                         height_over(triangle.end, crossing->on_core) <= 0;
  if (!is_inward) crossing.reset();
  return crossing;
}

void append_front(const OrganStep& step, const Core& core, const geometry::SegmentAndTriangle& pair,
                  std::uint32_t triangle, const geometry::Triangle& nodes, const Vec3& normal_end,
                  std::vector<FoundContact>& found) {
  FoundContact contact = contact_of(step, triangle, pair.on_triangle.weights);
  contact.normal_P = pair.distance > kDirectionless
                         ? Vec3((pair.on_segment - pair.on_triangle.point) / pair.distance)
                         : normal_end;
  contact.point_P = pair.on_segment - core.radius * contact.normal_P;
  contact.gap = contact.normal_P.dot(contact.point_P - pair.on_triangle.point);
  append_contact(contact, nodes, found);
}

void append_graze(const OrganStep& step, const Core& core, const CoreCandidate& candidate,
                  std::vector<FoundContact>& found) {
  const SweptTriangle& triangle = candidate.triangle;
  if (candidate.gap(core) > triangle.travel) return;
  const double touch = time_of_touch(core, triangle);
  if (touch >= 1) return;
  const ClosestApproach nearest = closest_approach(core, triangle, touch);
  if (nearest.pair.distance >= core.radius || nearest.pair.distance < kDirectionless) return;
  const Vec3 apart = nearest.pair.on_segment - nearest.pair.on_triangle.point;
  if (apart.dot(geometry::unit_normal(triangle.at(nearest.time))) <= 0) return;
  FoundContact contact = contact_of(step, candidate);
  contact.normal_P = apart / nearest.pair.distance;
  contact.barycentric = nearest.pair.on_triangle.weights;
  contact.point_P = nearest.pair.on_segment - core.radius * contact.normal_P;
  const Vec3 tissue = at_weights(triangle.end, contact.barycentric);
  contact.gap = contact.normal_P.dot(contact.point_P - tissue);
  if (contact.gap <= step.margin) append_contact(contact, triangle.nodes, found);
}

void append_nearest(const OrganStep& step, const Core& core, const CoreCandidate& candidate,
                    std::vector<FoundContact>& found) {
  const geometry::SegmentAndTriangle& pair = candidate.pair;
  FoundContact contact = contact_of(step, candidate);
  contact.normal_P = pair.distance > kDirectionless
                         ? Vec3((pair.on_triangle.point - pair.on_segment) / pair.distance)
                         : candidate.triangle.normal_end;
  contact.gap = -pair.distance - core.radius;
  contact.point_P = pair.on_triangle.point + contact.gap * contact.normal_P;
  append_contact(contact, candidate.triangle.nodes, found);
}

void append_wall(const OrganStep& step, const Core& core, double depth_limit,
                 std::vector<CoreCandidate>& candidates, WallBuffers& buffers,
                 std::vector<const CoreCandidate*>& behind, std::vector<FoundContact>& found) {
  mark_wall(step.organ, candidates, buffers);
  if (depth_limit == kInside && core.is_point()) {
    if (const CoreCandidate* const beside = behind_beside(candidates)) {
      for (CoreCandidate& c : candidates) {
        c.on_wall = false;
        c.remembered = &c == beside;
      }
      mark_wall(step.organ, candidates, buffers);
    }
  }
  const CoreCandidate* nearest = nullptr;
  for (const CoreCandidate& c : candidates) {
    if (!c.on_wall || c.side > 0) continue;
    if (nearest == nullptr || c.pair.distance < nearest->pair.distance) nearest = &c;
  }
  for (const CoreCandidate& c : candidates) {
    if (!c.on_wall) continue;
    if (c.side > 0 && !c.crossing) {
      if (c.gap(core) <= step.margin) {
        append_front(step, core, c.pair, c.triangle.index, c.triangle.nodes, c.triangle.normal_end,
                     found);
      }
      continue;
    }
    bool is_behind = c.side <= 0 && append_behind(step, core, c, depth_limit, &c == nearest, found);
    if (!is_behind && c.crossing) {
      append_crossed(step, core, c, found);
      is_behind = true;
    }
    if (is_behind) behind.push_back(&c);
  }
}

}  // namespace palpate::collision
