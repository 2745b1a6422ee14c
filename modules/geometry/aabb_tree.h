// A tree of axis-aligned boxes over the triangles of a surface that does not change.
#pragma once

#include <functional>
#include <optional>

#include "modules/geometry/box_tree.h"
#include "modules/geometry/triangle_surface.h"

namespace palpate::geometry {

class AabbTree {
 public:
  using Box = BoxTree::Box;

  /// Copies what it needs.
  explicit AabbTree(const TriangleSurface& surface);

  struct Nearest {
    std::uint32_t triangle = 0;
    Vec3 point = Vec3::Zero();    ///< on the surface [m]
    double squared_distance = 0;  ///< [m²]
  };
  /// The point of the surface nearest to `point`; of equally near triangles the first visited. Of
  /// a surface with triangles only.
  Nearest nearest(const Vec3& point) const;
  /// The same if it is nearer than that; else none, at once where all is far beyond.
  /// @param squared_limit  [m²]
  std::optional<Nearest> nearest_within(const Vec3& point, double squared_limit) const;

  /// Appends the triangles whose own boxes touch `box`, in no useful order.
  void append_overlapping(const Box& box, std::vector<std::uint32_t>& triangles) const {
    tree_.append_overlapping(box, triangles);
  }
  const BoxTree& boxes() const { return tree_; }

  /// Calls `visit(a, b)`, a < b, once for every pair of triangles whose boxes touch.
  void for_each_touching_pair(const std::function<void(std::uint32_t, std::uint32_t)>& visit) const;

 private:
  std::vector<std::array<Vec3, 3>> corners_;  // of each triangle
  BoxTree tree_;
};

/// The point of the triangle (a, b, c) nearest to p. Ericson, Real-Time Collision Detection,
/// §5.1.5.
Vec3 nearest_point_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace palpate::geometry
