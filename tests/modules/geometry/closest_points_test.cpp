#include "modules/geometry/closest_points.h"

#include <catch2/catch.hpp>

#include "tests/collision/random_shapes.h"

namespace palpate::geometry {
namespace {

using collision::RandomShapes;

constexpr int kSamples = 60;  // per direction

double sampled_distance(const Vec3& p, const TriangleCorners& t) {
  double best = 1e300;
  for (int i = 0; i <= kSamples; ++i) {
    for (int j = 0; i + j <= kSamples; ++j) {
      const double u = double(i) / kSamples, v = double(j) / kSamples;
      best = std::min(best, (p - ((1 - u - v) * t[0] + u * t[1] + v * t[2])).norm());
    }
  }
  return best;
}

double longest_edge(const TriangleCorners& t) {
  return std::max({(t[1] - t[0]).norm(), (t[2] - t[1]).norm(), (t[0] - t[2]).norm()});
}

}  // namespace

TEST_CASE("closest point of a triangle: no sampled point is closer, and sampling comes near it") {
  // Oracle: brute force, dense sampling; a grid point is within one cell of any point.
  RandomShapes random(1);
  for (int trial = 0; trial < 300; ++trial) {
    const TriangleCorners t = random.triangle(1);
    const Vec3 p = random.point(2);
    const PointOnTriangle closest = closest_on_triangle(p, t);
    const double distance = (p - closest.point).norm(), sampled = sampled_distance(p, t);
    CHECK(distance <= sampled + 1e-12);
    CHECK(distance >= sampled - longest_edge(t) / kSamples);
  }
}

TEST_CASE(
    "closest point of a triangle: weights are barycentric, and exactly zero off the feature") {
  // Oracle: invariant.
  RandomShapes random(2);
  for (int trial = 0; trial < 1000; ++trial) {
    const TriangleCorners t = random.triangle(1);
    const Vec3 p = random.point(2);
    const PointOnTriangle closest = closest_on_triangle(p, t);
    CHECK(closest.weights.minCoeff() >= 0);
    CHECK(closest.weights.sum() == Approx(1).epsilon(1e-14));
    const Vec3 named =
        closest.weights[0] * t[0] + closest.weights[1] * t[1] + closest.weights[2] * t[2];
    CHECK((named - closest.point).norm() < 1e-14);
  }
  const TriangleCorners t{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
  CHECK(closest_on_triangle({-1, -1, 1}, t).weights == Vec3(1, 0, 0));
  CHECK(closest_on_triangle({0.25, -1, 1}, t).weights == Vec3(0.75, 0.25, 0));
  CHECK(closest_on_triangle({0.25, 0.25, 3}, t).weights == Vec3(0.5, 0.25, 0.25));
}

TEST_CASE("closest points of segments: no sampled pair is closer") {
  // Oracle: brute force, dense sampling.
  RandomShapes random(3);
  for (int trial = 0; trial < 500; ++trial) {
    const Vec3 a0 = random.point(1), a1 = random.point(1), b0 = random.point(1);
    // Every fourth pair is parallel, every seventh has a point for a segment.
    const Vec3 b1 = trial % 7 == 0   ? b0
                    : trial % 4 == 0 ? Vec3(b0 + 0.7 * (a1 - a0))
                                     : random.point(1);
    const SegmentPair pair = closest_of_segments(a0, a1, b0, b1);
    const double distance = (pair.on_first - pair.on_second).norm();
    double sampled = 1e300;
    for (int i = 0; i <= kSamples; ++i) {
      for (int j = 0; j <= kSamples; ++j) {
        const Vec3 a = a0 + double(i) / kSamples * (a1 - a0),
                   b = b0 + double(j) / kSamples * (b1 - b0);
        sampled = std::min(sampled, (a - b).norm());
      }
    }
    CHECK(distance <= sampled + 1e-9);
    CHECK(distance >= sampled - ((a1 - a0).norm() + (b1 - b0).norm()) / kSamples);
    CHECK((a0 + pair.s * (a1 - a0) - pair.on_first).norm() < 1e-14);
    CHECK((b0 + pair.t * (b1 - b0) - pair.on_second).norm() < 1e-14);
  }
}

TEST_CASE("closest points of segment and triangle: no point of the segment is closer") {
  // Oracle: brute force, the exact point query along a densely sampled segment.
  RandomShapes random(4);
  int intersecting = 0;
  for (int trial = 0; trial < 500; ++trial) {
    const TriangleCorners t = random.triangle(1);
    const Vec3 a = random.point(1.5), b = random.point(1.5);
    const SegmentAndTriangle pair = closest_of_segment_and_triangle(a, b, t);
    intersecting += pair.distance == 0;
    double sampled = 1e300;
    for (int i = 0; i <= 400; ++i) {
      const Vec3 p = a + i / 400.0 * (b - a);
      sampled = std::min(sampled, (p - closest_on_triangle(p, t).point).norm());
    }
    CHECK(pair.distance <= sampled + 1e-12);
    CHECK(pair.distance >= sampled - (b - a).norm() / 800);
    CHECK((pair.on_segment - pair.on_triangle.point).norm() == Approx(pair.distance).margin(1e-12));
  }
  CHECK(intersecting > 20);
}

TEST_CASE("unit normal: outward for counter-clockwise corners, zero for what has no area") {
  // Oracle: analytic.
  CHECK(unit_normal({Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(0, 3, 0)}) == Vec3(0, 0, 1));
  CHECK(unit_normal({Vec3(0, 0, 0), Vec3(1, 1, 1), Vec3(3, 3, 3)}) == Vec3::Zero());
  CHECK(unit_normal({Vec3(1, 2, 3), Vec3(1, 2, 3), Vec3(1, 2, 3)}) == Vec3::Zero());
  CHECK(unit_normal({Vec3(NAN, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)}) == Vec3::Zero());
}

}  // namespace palpate::geometry
