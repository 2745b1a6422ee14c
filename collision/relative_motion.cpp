#include "collision/relative_motion.h"

#include <algorithm>
#include <cmath>

namespace palpate::collision {
namespace {

constexpr double kRounding = 1e-12;  // [m], and relative: a way of 1 m is known to 1e-15

Vec3 sum_of_area_vectors(const OrganSurface& organ, const NodeArray& positions,
                         std::span<const std::uint32_t> triangles) {
  Vec3 sum = Vec3::Zero();
  for (const std::uint32_t t : triangles) {
    const auto& [a, b, c] = organ.triangles()[t];
    sum += 0.5 * (positions[b] - positions[a]).cross(positions[c] - positions[a]);
  }
  return sum;
}

/// Adds the bounds of a box turned and then moved by `by`.
void add_turned(const Mat3& rotation, const Bounds& box, const Vec3& by, Bounds& to) {
  const Vec3 centre = by + rotation * (0.5 * (box.lower + box.upper));
  const Vec3 half = rotation.cwiseAbs() * (0.5 * (box.upper - box.lower));
  to.add(centre - half);
  to.add(centre + half);
}

}  // namespace

RelativeMotion::RelativeMotion(const ProbeMotion& motion, double reach, bool round)
    : position_start_(motion.pose_t0.position), position_end_(motion.pose_t1.position) {
  const Quat end = motion.pose_t1.rotation.normalized();
  const Quat start = round ? end : motion.pose_t0.rotation.normalized();
  to_start_ = start.conjugate().toRotationMatrix();
  to_end_ = end.conjugate().toRotationMatrix();
  const double angle = round ? 0 : start.angularDistance(end);
  chord_error_ = (angle * angle * reach + 2 * angle * travel()) / 8;
}

Bounds RelativeMotion::swept(const Bounds& box_P) const {
  Bounds result;
  for (const auto& [rotation, position] :
       {std::pair(&to_start_, &position_start_), std::pair(&to_end_, &position_end_)}) {
    add_turned(rotation->transpose(), box_P, *position, result);
  }
  return result;
}

Bounds RelativeMotion::seen(const Bounds& box_W) const {
  Bounds result;
  add_turned(to_start_, box_W, -(to_start_ * position_start_), result);
  add_turned(to_end_, box_W, -(to_end_ * position_end_), result);
  return result;
}

geometry::TriangleCorners SweptTriangle::at(double t) const {
  geometry::TriangleCorners corners;
  for (int k = 0; k < 3; ++k) corners[k] = start[k] + t * (end[k] - start[k]);
  return corners;
}

Bounds SweptTriangle::bounds() const {
  Bounds box;
  for (int k = 0; k < 3; ++k) {
    box.add(start[k]);
    box.add(end[k]);
  }
  return box;
}

double SweptTriangle::travel_of(double squared) {
  return std::sqrt(squared) * (1 + kRounding) + kRounding;
}

bool SweptTriangle::complete(std::uint32_t triangle, const geometry::Triangle& corners,
                             double travel_squared) {
  index = triangle;
  nodes = corners;
  travel = travel_of(travel_squared);
  normal_end = geometry::unit_normal(end);
  return normal_end != Vec3::Zero();
}

bool OrganStep::sweep(std::uint32_t triangle, SweptTriangle& result) const {
  const geometry::Triangle& nodes = organ.triangles()[triangle];
  double squared = 0;
  for (int k = 0; k < 3; ++k) {
    result.start[k] = node_start(nodes[k]);
    result.end[k] = node_end(nodes[k]);
    squared = std::max(squared, (result.end[k] - result.start[k]).squaredNorm());
  }
  return result.complete(triangle, nodes, squared);
}

Vec3 OrganStep::node_normal_end(std::uint32_t node) const {
  return motion.direction_at_end(
      sum_of_area_vectors(organ, organ.positions(), organ.triangles_of_node(node)));
}

Vec3 OrganStep::edge_normal_start(std::uint32_t edge) const {
  return motion.direction_at_start(
      sum_of_area_vectors(organ, start_positions(), organ.edges()[edge].triangles));
}

Vec3 OrganStep::edge_normal_end(std::uint32_t edge) const {
  return motion.direction_at_end(
      sum_of_area_vectors(organ, organ.positions(), organ.edges()[edge].triangles));
}

}  // namespace palpate::collision
