#include "deformation/contact/touch_follower.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "modules/geometry/closest_points.h"

namespace palpate::deformation {
namespace {

/// All over R.
constexpr double kReach = 2, kLeave = 2.5, kPatch = 0.5, kStay = 0.25, kGrid = 1.0 / 16;
constexpr double kPlateau = 1 + kStay;

/// Longer edges err by more than the finer ones' law says: 1.3 in the median at 1.75 radii.
constexpr double kErrorAtRadius = 0.27, kErrorOrder = 1.6, kCoarseOrder = 2.8;
constexpr std::size_t kMostBalls = 24, kMostCorners = 16;

/// Points that lie furthest apart, one after the other, from the first on.
std::vector<Vec3> corners_of(const std::vector<Vec3>& points) {
  std::vector<Vec3> corners;
  std::vector<double> away(points.size(), std::numeric_limits<double>::infinity());
  std::size_t next = 0;
  while (corners.size() < std::min(kMostCorners, points.size())) {
    corners.push_back(points[next]);
    for (std::size_t i = 0; i < points.size(); ++i) {
      away[i] = std::min(away[i], (points[i] - points[next]).norm());
    }
    next = static_cast<std::size_t>(std::ranges::max_element(away) - away.begin());
  }
  return corners;
}

double least_extent(const std::vector<Vec3>& points) {
  Vec3 low = points.front(), high = low;
  for (const Vec3& x : points) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  return (high - low).minCoeff();
}

}  // namespace

double edge_over_radius(double force_error) {
  return std::clamp(std::pow(force_error / kErrorAtRadius, 1 / kErrorOrder), 0.25, 1.0);
}

double force_error_of_edge(double edge_over_radius) {
  const double order = edge_over_radius < 1 ? kErrorOrder : kCoarseOrder;
  return kErrorAtRadius * std::pow(edge_over_radius, order);
}

double quadratic_edge_over_radius(double force_error) {
  return std::clamp(std::pow(force_error / 0.027, 1 / 2.65), 0.7, 1.0);
}

TouchFollower::TouchFollower(const geometry::ProbeForm& form, std::optional<double> edge,
                             double edge_over_radius) {
  if (const auto* core = std::get_if<geometry::RoundedSegment>(&form)) {
    radius_ = ball_radius_ = core->radius;
    const double length = (core->b - core->a).norm();
    const auto gaps =
        std::min(kMostBalls - 1, static_cast<std::size_t>(std::ceil(length / radius_)));
    for (std::size_t i = 0; i <= gaps; ++i) {
      const double at = gaps == 0 ? 0 : static_cast<double>(i) / static_cast<double>(gaps);
      samples_.push_back({core->a + at * (core->b - core->a), {}});
    }
  } else if (!std::holds_alternative<geometry::HalfSpace>(form)) {
    const std::vector<Vec3> points = geometry::surface_of(form, 0).nodes;
    if (!points.empty()) radius_ = least_extent(points) / 2;
    if (radius_ > 0) {
      for (const Vec3& corner : corners_of(points)) samples_.push_back({corner, {}});
    }
  }
  edge_ = edge.value_or(edge_over_radius * radius_);
}

void TouchFollower::reset() {
  for (Sample& sample : samples_) sample.place.reset();
}

void TouchFollower::look(const Pose& pose, const Body& body, std::span<const Vec3> positions,
                         std::vector<TouchedPlace>& places) {
  for (Sample& sample : samples_) {
    const double reach = (sample.place ? kLeave : kReach) * radius_;
    const auto mean = mean_near(pose.to_world(sample.centre_P), reach, body, positions);
    if (!mean) {
      sample.place.reset();
      continue;
    }
    if (!sample.place || (*mean - *sample.place).norm() > kStay * radius_) {
      const double grid = kGrid * radius_;
      sample.place = (*mean / grid).array().round().matrix() * grid;
    }
    places.push_back({*sample.place, kPlateau * radius_, edge_});
  }
}

std::optional<Vec3> TouchFollower::mean_near(const Vec3& centre, double reach, const Body& body,
                                             std::span<const Vec3> positions) {
  near_.clear();
  double least = reach;
  for (const geometry::Triangle& t : body.triangles) {
    const geometry::TriangleCorners x{positions[t[0]], positions[t[1]], positions[t[2]]};
    const Vec3 u = x[1] - x[0], v = x[2] - x[0];
    const double far = ball_radius_ + least + kPatch * radius_;
    const double size = std::sqrt(std::max(u.squaredNorm(), v.squaredNorm()));
    if ((x[0] - centre).squaredNorm() > (far + size) * (far + size)) continue;
    const geometry::PointOnTriangle at = geometry::closest_on_triangle(centre, x);
    const double gap = (at.point - centre).norm() - ball_radius_;
    if (gap > least + kPatch * radius_) continue;
    least = std::min(least, gap);
    Near near{gap, u.cross(v).norm(), Vec3::Zero()};
    for (std::size_t k = 0; k < 3; ++k) {
      near.rest += at.weights[static_cast<Eigen::Index>(k)] * body.rest_positions[t[k]];
    }
    near_.push_back(near);
  }
  if (!(least < reach)) return {};
  Vec3 sum = Vec3::Zero();
  double weights = 0;
  for (const Near& near : near_) {
    const double closeness = std::max(0.0, 1 - (near.gap - least) / (kPatch * radius_));
    const double weight = near.area * closeness * closeness;
    sum += weight * near.rest;
    weights += weight;
  }
  if (!(weights > 0)) return {};
  return sum / weights;
}

}  // namespace palpate::deformation
