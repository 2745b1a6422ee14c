#include "modules/geometry/aabb_tree.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

#include "modules/core/error.h"

namespace palpate::geometry {
namespace {

constexpr std::uint32_t kLeafSize = 4;

}  // namespace

AabbTree::AabbTree(const TriangleSurface& surface) {
  for (const auto& [a, b, c] : surface.triangles) {
    corners_.push_back({surface.nodes[a], surface.nodes[b], surface.nodes[c]});
    Box box(surface.nodes[a]);
    box.extend(surface.nodes[b]).extend(surface.nodes[c]);
    boxes_.push_back(box);
  }
  order_.resize(boxes_.size());
  std::iota(order_.begin(), order_.end(), 0u);
  build();
}

void AabbTree::build() {
  branches_.push_back({Box(), 0, static_cast<std::uint32_t>(order_.size()), 0});
  for (std::uint32_t i = 0; i < branches_.size(); ++i) split(i);
}

void AabbTree::split(std::uint32_t branch) {
  const std::uint32_t begin = branches_[branch].begin, end = branches_[branch].end;
  Box box, centres;
  for (std::uint32_t i = begin; i < end; ++i) {
    box.extend(boxes_[order_[i]]);
    centres.extend(boxes_[order_[i]].center());
  }
  branches_[branch].box = box;
  if (end - begin <= kLeafSize) return;
  Eigen::Index axis = 0;
  centres.sizes().maxCoeff(&axis);
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                   [&](std::uint32_t a, std::uint32_t b) {
                     const double at_a = boxes_[a].center()[axis], at_b = boxes_[b].center()[axis];
                     return at_a != at_b ? at_a < at_b : a < b;
                   });
  branches_[branch].left = static_cast<std::uint32_t>(branches_.size());
  branches_.push_back({Box(), begin, middle, 0});
  branches_.push_back({Box(), middle, end, 0});
}

Vec3 AabbTree::nearest_on(std::uint32_t triangle, const Vec3& point) const {
  const auto& [a, b, c] = corners_[triangle];
  return nearest_point_on_triangle(point, a, b, c);
}

AabbTree::Nearest AabbTree::nearest(const Vec3& point) const {
  PALPATE_DEMAND(!order_.empty());
  constexpr double kAnywhere = std::numeric_limits<double>::infinity();
  return nearest_within(point, kAnywhere).value_or(Nearest{0, Vec3::Zero(), kAnywhere});
}

std::optional<AabbTree::Nearest> AabbTree::nearest_within(const Vec3& point,
                                                          double squared_limit) const {
  Nearest best;
  best.squared_distance = squared_limit;
  std::vector<std::uint32_t> open{0};
  while (!open.empty()) {
    const Branch& branch = branches_[open.back()];
    open.pop_back();
    if (branch.box.squaredExteriorDistance(point) >= best.squared_distance) continue;
    if (branch.left == 0) {
      for (std::uint32_t i = branch.begin; i < branch.end; ++i) {
        const Vec3 on_triangle = nearest_on(order_[i], point);
        const double squared_distance = (on_triangle - point).squaredNorm();
        if (squared_distance < best.squared_distance) {
          best = {order_[i], on_triangle, squared_distance};
        }
      }
      continue;
    }
    const std::uint32_t left = branch.left, right = branch.left + 1;
    const bool left_first = branches_[left].box.squaredExteriorDistance(point) <=
                            branches_[right].box.squaredExteriorDistance(point);
    open.push_back(left_first ? right : left);
    open.push_back(left_first ? left : right);
  }
  if (best.squared_distance < squared_limit) return best;
  return std::nullopt;
}

void AabbTree::append_overlapping(const Box& box, std::vector<std::uint32_t>& triangles) const {
  std::array<std::uint32_t, 64> open;  // depth first: at most one waiting branch per halving
  std::size_t waiting = 1;
  open[0] = 0;
  while (waiting > 0) {
    const Branch& branch = branches_[open[--waiting]];
    if (!branch.box.intersects(box)) continue;
    if (branch.left != 0) {
      open[waiting++] = branch.left + 1;
      open[waiting++] = branch.left;
      continue;
    }
    for (std::uint32_t i = branch.begin; i < branch.end; ++i) {
      if (boxes_[order_[i]].intersects(box)) triangles.push_back(order_[i]);
    }
  }
}

void AabbTree::for_each_touching_pair(
    const std::function<void(std::uint32_t, std::uint32_t)>& visit) const {
  std::vector<std::uint32_t> near;
  for (std::uint32_t a = 0; a < boxes_.size(); ++a) {
    near.clear();
    append_overlapping(boxes_[a], near);
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
