#include "collision/relative_motion.h"

#include <algorithm>
#include <cmath>

namespace palpate::collision {
namespace {

constexpr double kRounding = 1e-12;  // [m], and relative: a way of 1 m is known to 1e-15

Vec3 sum_of_area_vectors(const OrganSurface& organ, const std::vector<Vec3>& positions,
                         std::span<const std::uint32_t> triangles) {
  Vec3 sum = Vec3::Zero();
  for (const std::uint32_t t : triangles) {
    sum += geometry::area_vector(positions, organ.triangles()[t]);
  }
  return sum;
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
  const Vec3 center = 0.5 * (box_P.lower + box_P.upper), half = 0.5 * (box_P.upper - box_P.lower);
  Bounds result;
  for (const auto& [rotation, position] :
       {std::pair(&to_start_, &position_start_), std::pair(&to_end_, &position_end_)}) {
    const Vec3 at = *position + rotation->transpose() * center;
    const Vec3 extent = rotation->transpose().cwiseAbs() * half;
    result.add(at - extent);
    result.add(at + extent);
  }
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

bool OrganStep::sweep(std::uint32_t triangle, SweptTriangle& result) const {
  result.index = triangle;
  result.nodes = organ.triangles()[triangle];
  double squared = 0;
  for (int k = 0; k < 3; ++k) {
    result.start[k] = node_start(result.nodes[k]);
    result.end[k] = node_end(result.nodes[k]);
    squared = std::max(squared, (result.end[k] - result.start[k]).squaredNorm());
  }
  result.travel = std::sqrt(squared) * (1 + kRounding) + kRounding;
  result.normal_end = geometry::unit_normal(result.end);
  return result.normal_end != Vec3::Zero();
}

Vec3 OrganStep::node_normal_end(std::uint32_t node) const {
  return motion.direction_at_end(
      sum_of_area_vectors(organ, organ.positions(), organ.triangles_of_node(node)));
}

Vec3 OrganStep::edge_normal_start(std::uint32_t edge) const {
  return motion.direction_at_start(
      sum_of_area_vectors(organ, start_positions, organ.edges()[edge].triangles));
}

Vec3 OrganStep::edge_normal_end(std::uint32_t edge) const {
  return motion.direction_at_end(
      sum_of_area_vectors(organ, organ.positions(), organ.edges()[edge].triangles));
}

}  // namespace palpate::collision
