#include "collision/core_sweep.h"

#include <algorithm>

#include "modules/geometry/continuous_collision.h"

namespace palpate::collision {
namespace {

constexpr double kTouchTolerance = 1e-6;  // of the radius
constexpr int kMaxAdvances = 100;         // then the time reached so far is the (safe) answer
constexpr int kGoldenSteps = 40;          // 0.618⁴⁰ < 1e-8 of the step
constexpr double kGolden = 0.6180339887498949;

void take_if_earlier(const std::optional<geometry::Impact>& impact, const Vec3& on_core,
                     const Vec3& weights, std::optional<Crossing>& first) {
  if (impact && (!first || impact->time < first->time)) {
    first = Crossing{impact->time, on_core, weights};
  }
}

void cross_with_point(const Vec3& p, const SweptTriangle& t, double separation,
                      std::optional<Crossing>& first) {
  const auto impact = geometry::point_triangle_impact(
      {p, t.start[0], t.start[1], t.start[2]}, {p, t.end[0], t.end[1], t.end[2]}, separation);
  if (!impact) return;
  const double u = impact->u, v = std::min(impact->v, 1 - impact->u);
  take_if_earlier(impact, p, {1 - u - v, u, v}, first);
}

}  // namespace

geometry::SegmentAndTriangle closest(const Core& core, const geometry::TriangleCorners& triangle) {
  if (!core.is_point()) return geometry::closest_of_segment_and_triangle(core.a, core.b, triangle);
  const geometry::PointOnTriangle on_triangle = geometry::closest_on_triangle(core.a, triangle);
  return {core.a, on_triangle, (core.a - on_triangle.point).norm()};
}

double time_of_touch(const Core& core, const SweptTriangle& triangle) {
  double time = 0;
  for (int advance = 0; advance < kMaxAdvances; ++advance) {
    const double apart = closest(core, triangle.at(time)).distance - core.radius;
    if (apart <= kTouchTolerance * core.radius) return time;
    if (apart >= (1 - time) * triangle.travel) return 1;
    time += apart / triangle.travel;
  }
  return time;
}

ClosestApproach closest_approach(const Core& core, const SweptTriangle& triangle, double from) {
  // For a translation the distance is a convex function of time, so golden sections find its
  // minimum; triangles that also deform within a step do so little.
  double low = from, high = 1;
  const auto distance = [&](double t) { return closest(core, triangle.at(t)).distance; };
  double inner_low = high - kGolden * (high - low), inner_high = low + kGolden * (high - low);
  double at_low = distance(inner_low), at_high = distance(inner_high);
  for (int step = 0; step < kGoldenSteps; ++step) {
    if (at_low <= at_high) {
      high = inner_high;
      inner_high = inner_low;
      at_high = at_low;
      inner_low = high - kGolden * (high - low);
      at_low = distance(inner_low);
    } else {
      low = inner_low;
      inner_low = inner_high;
      at_low = at_high;
      inner_high = low + kGolden * (high - low);
      at_high = distance(inner_high);
    }
  }
  const double time = at_low <= at_high ? inner_low : inner_high;
  return {time, closest(core, triangle.at(time))};
}

std::optional<Crossing> first_crossing(const Core& core, const SweptTriangle& triangle,
                                       double separation) {
  std::optional<Crossing> first;
  cross_with_point(core.a, triangle, separation, first);
  if (core.is_point()) return first;
  cross_with_point(core.b, triangle, separation, first);
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    const auto impact = geometry::edge_edge_impact(
        {core.a, core.b, triangle.start[k], triangle.start[next]},
        {core.a, core.b, triangle.end[k], triangle.end[next]}, separation);
    if (!impact) continue;
    Vec3 weights = Vec3::Zero();
    weights[k] = 1 - impact->v;
    weights[next] = impact->v;
    take_if_earlier(impact, core.a + impact->u * (core.b - core.a), weights, first);
  }
  return first;
}

}  // namespace palpate::collision
