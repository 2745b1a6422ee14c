#include "modules/geometry/aabb_tree.h"

#include <limits>

#include "modules/core/error.h"

namespace palpate::geometry {
namespace {

std::vector<BoxTree::Box> boxes_of(const TriangleSurface& surface) {
  std::vector<BoxTree::Box> boxes;
  for (const auto& [a, b, c] : surface.triangles) {
    BoxTree::Box box(surface.nodes[a]);
    boxes.push_back(box.extend(surface.nodes[b]).extend(surface.nodes[c]));
  }
  return boxes;
}

}  // namespace

AabbTree::AabbTree(const TriangleSurface& surface) : tree_(boxes_of(surface)) {
  for (const auto& [a, b, c] : surface.triangles) {
    corners_.push_back({surface.nodes[a], surface.nodes[b], surface.nodes[c]});
  }
}

AabbTree::Nearest AabbTree::nearest(const Vec3& point) const {
  PALPATE_DEMAND(!corners_.empty());
  constexpr double kAnywhere = std::numeric_limits<double>::infinity();
  return nearest_within(point, kAnywhere).value_or(Nearest{0, Vec3::Zero(), kAnywhere});
}

std::optional<AabbTree::Nearest> AabbTree::nearest_within(const Vec3& point,
                                                          double squared_limit) const {
  Nearest best;
  best.squared_distance = squared_limit;
  tree_.visit_near([&](const Box& box) { return box.squaredExteriorDistance(point); },
                   [&] { return best.squared_distance; },
                   [&](std::uint32_t triangle) {
                     const auto& [a, b, c] = corners_[triangle];
                     const Vec3 on_triangle = nearest_point_on_triangle(point, a, b, c);
                     const double squared_distance = (on_triangle - point).squaredNorm();
                     if (squared_distance < best.squared_distance) {
                       best = {triangle, on_triangle, squared_distance};
                     }
                   });
  if (best.squared_distance < squared_limit) return best;
  return std::nullopt;
}

void AabbTree::for_each_touching_pair(
    const std::function<void(std::uint32_t, std::uint32_t)>& visit) const {
  std::vector<std::uint32_t> near;
  for (std::uint32_t a = 0; a < corners_.size(); ++a) {
    near.clear();
    append_overlapping(tree_.boxes()[a], near);
    for (const std::uint32_t b : near) {
      if (b > a) visit(a, b);
    }
  }
}

Vec3 nearest_point_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return a;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return b;
  const double v_c = d1 * d4 - d3 * d2;
  if (v_c <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return c;
  const double v_b = d5 * d2 - d1 * d6;
  if (v_b <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
  const double v_a = d3 * d6 - d5 * d4;
  if (v_a <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
  }
  const double sum = v_a + v_b + v_c;
  if (sum == 0) return a;  // no area
  return a + v_b / sum * ab + v_c / sum * ac;
}

}  // namespace palpate::geometry
