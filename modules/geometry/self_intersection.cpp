#include "modules/geometry/self_intersection.h"

#include <algorithm>

#include "modules/geometry/aabb_tree.h"

namespace palpate::geometry {
namespace {

constexpr double kFlat = 1e-9;  // of the triangles' size

using Corners = std::array<Vec3, 3>;

Corners corners_of(std::span<const Vec3> nodes, const Triangle& triangle) {
  return {nodes[triangle[0]], nodes[triangle[1]], nodes[triangle[2]]};
}

bool contains(const Triangle& triangle, std::uint32_t node) {
  return std::find(triangle.begin(), triangle.end(), node) != triangle.end();
}

/// Whether the segment (p, q) meets the triangle, not counting segments in its plane.
bool segment_pierces(const Vec3& p, const Vec3& q, const Corners& t, const Vec3& normal) {
  const double height_p = normal.dot(p - t[0]), height_q = normal.dot(q - t[0]);
  if ((height_p > 0 && height_q > 0) || (height_p < 0 && height_q < 0)) return false;
  if (height_p == height_q) return false;
  const Vec3 x = p + height_p / (height_p - height_q) * (q - p);
  for (int i = 0; i < 3; ++i) {
    if (normal.dot((t[(i + 1) % 3] - t[i]).cross(x - t[i])) < 0) return false;
  }
  return true;
}

/// Whether an edge of `first` that touches no node of `second` pierces `second`.
bool an_edge_pierces(std::span<const Vec3> nodes, const Triangle& first, const Triangle& second,
                     const Vec3& second_normal) {
  const Corners corners = corners_of(nodes, second);
  for (int i = 0; i < 3; ++i) {
    const std::uint32_t p = first[i], q = first[(i + 1) % 3];
    if (contains(second, p) || contains(second, q)) continue;
    if (segment_pierces(nodes[p], nodes[q], corners, second_normal)) return true;
  }
  return false;
}

/// Separating axes in the common plane: overlap of the insides beyond `tolerance` [m].
bool overlap_in_plane(const Corners& first, const Corners& second, const Vec3& unit_normal,
                      double tolerance) {
  for (const Corners* triangle : {&first, &second}) {
    for (int i = 0; i < 3; ++i) {
      const Vec3 edge = (*triangle)[(i + 1) % 3] - (*triangle)[i];
      const Vec3 axis = unit_normal.cross(edge).normalized();
      const auto range = [&](const Corners& t) {
        return std::minmax(
            {axis.dot(t[0] - first[0]), axis.dot(t[1] - first[0]), axis.dot(t[2] - first[0])});
      };
      const auto [low_1, high_1] = range(first);
      const auto [low_2, high_2] = range(second);
      if (std::min(high_1, high_2) - std::max(low_1, low_2) <= tolerance) return false;
    }
  }
  return true;
}

}  // namespace

bool triangles_intersect(std::span<const Vec3> nodes, const Triangle& first,
                         const Triangle& second) {
  const Corners corners_1 = corners_of(nodes, first), corners_2 = corners_of(nodes, second);
  const Vec3 normal_1 = area_vector(nodes, first), normal_2 = area_vector(nodes, second);
  const double area_1 = normal_1.norm(), area_2 = normal_2.norm();
  if (area_1 == 0 || area_2 == 0) return false;
  double size = 0;
  for (int i = 0; i < 3; ++i) {
    size = std::max(
        {size, (corners_1[i] - corners_1[0]).norm(), (corners_2[i] - corners_2[0]).norm()});
  }
  double highest = 0;  // of the second over the first one's plane
  for (const Vec3& corner : corners_2) {
    highest = std::max(highest, std::abs(normal_1.dot(corner - corners_1[0])) / area_1);
  }
  if (highest <= kFlat * size) {
    return overlap_in_plane(corners_1, corners_2, normal_1 / area_1, kFlat * size);
  }
  const auto shared = std::count_if(first.begin(), first.end(),
                                    [&](std::uint32_t node) { return contains(second, node); });
  if (shared >= 2) return false;
  return an_edge_pierces(nodes, first, second, normal_2) ||
         an_edge_pierces(nodes, second, first, normal_1);
}

std::vector<std::array<std::uint32_t, 2>> find_self_intersections(const TriangleSurface& surface) {
  std::vector<std::array<std::uint32_t, 2>> pairs;
  if (surface.triangles.empty()) return pairs;
  AabbTree(surface).for_each_touching_pair([&](std::uint32_t a, std::uint32_t b) {
    if (triangles_intersect(surface.nodes, surface.triangles[a], surface.triangles[b])) {
      pairs.push_back({a, b});
    }
  });
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace palpate::geometry
