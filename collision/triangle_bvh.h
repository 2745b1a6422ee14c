// Which triangles of a deforming surface are near a box: FCL's bounding volume hierarchy behind a
// plain header.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "modules/geometry/triangle_surface.h"

namespace palpate::collision {

/// Axis-aligned box [m]; empty until something is added.
struct Bounds {
  Vec3 lower = Vec3::Constant(1e300), upper = Vec3::Constant(-1e300);

  void add(const Vec3& p) {
    lower = lower.cwiseMin(p);
    upper = upper.cwiseMax(p);
  }
  void inflate(double by) {
    lower.array() -= by;
    upper.array() += by;
  }
  bool overlaps(const Bounds& other) const {
    return (lower.array() <= other.upper.array()).all() &&
           (other.lower.array() <= upper.array()).all();
  }
};

class TriangleBvh {
 public:
  /// @param nodes  finite; as many in every later refit()
  TriangleBvh(const std::vector<Vec3>& nodes, std::span<const geometry::Triangle> triangles);
  ~TriangleBvh();
  TriangleBvh(TriangleBvh&&) noexcept;
  TriangleBvh& operator=(TriangleBvh&&) noexcept;

  /// Moves the surface. Moving all boxes of the tree costs more than many queries, so they follow
  /// only once a node is further than the mean edge length from where they were fitted; until then
  /// queries are widened by that distance.
  void move(const std::vector<Vec3>& nodes);

  /// Of all nodes, a little wide.
  Bounds bounds() const;

  /// Appends at least the triangles whose own bounds overlap `box`, in no useful order.
  void append_overlapping(const Bounds& box, std::vector<std::uint32_t>& triangles) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::collision
