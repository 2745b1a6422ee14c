#include "deformation/contact/outer_seat.h"

#include <limits>

#include "modules/geometry/closest_points.h"
#include "modules/geometry/winding_number.h"

namespace palpate::deformation {
namespace {

constexpr double kOff = 1e-6;     ///< so far beyond a point its wall is put [m]
constexpr int kMostSeatings = 8;  ///< rounds over all points

bool is_inside(const Vec3& p, const Body& body, std::span<const Vec3> positions) {
  return geometry::winding_number(p, positions.first(body.surface_node_count), body.triangles) >
         0.5;
}

struct NearestWall {
  const geometry::Triangle* nodes = nullptr;
  Vec3 weights = Vec3::Zero();
  Vec3 way = Vec3::Zero();  ///< from there to the point [m]
};

NearestWall nearest_wall(const Vec3& p, const Body& body, std::span<const Vec3> positions) {
  NearestWall nearest;
  double least = std::numeric_limits<double>::infinity();
  for (const geometry::Triangle& t : body.triangles) {
    const auto at =
        geometry::closest_on_triangle(p, {positions[t[0]], positions[t[1]], positions[t[2]]});
    const double squared = (p - at.point).squaredNorm();
    if (!(squared < least)) continue;
    least = squared;
    nearest = {&t, at.weights, p - at.point};
  }
  return nearest;
}

/// The nearest place comes to the point by the least motion of its corners, Σ |Δx|².
void move_to(const NearestWall& wall, const Body& body, std::span<Vec3> positions) {
  const double distance = wall.way.norm();
  if (wall.nodes == nullptr || !(distance > 0)) return;
  Vec3 moved = Vec3::Zero();
  for (int k = 0; k < 3; ++k) {
    if (body.inverse_masses[(*wall.nodes)[k]] > 0) moved[k] = wall.weights[k];
  }
  const double squares = moved.squaredNorm();
  if (!(squares > 0)) return;  // held
  const Vec3 way = wall.way * (1 + kOff / distance);
  for (int k = 0; k < 3; ++k) positions[(*wall.nodes)[k]] += moved[k] / squares * way;
}

}  // namespace

bool seat_outside(std::span<const Vec3> points, const Body& body, std::span<Vec3> positions) {
  for (int round = 0; round <= kMostSeatings; ++round) {
    bool any = false;
    for (const Vec3& p : points) {
      if (!is_inside(p, body, positions)) continue;
      any = true;
      if (round < kMostSeatings) move_to(nearest_wall(p, body, positions), body, positions);
    }
    if (!any) return true;
  }
  return false;
}

}  // namespace palpate::deformation
