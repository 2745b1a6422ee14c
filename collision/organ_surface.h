// The newest surface of one organ, and the one before it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "collision/triangle_bvh.h"

namespace palpate::collision {

struct SurfaceEdge {
  std::array<std::uint32_t, 2> nodes{};      ///< a < b
  std::array<std::uint32_t, 2> triangles{};  ///< lowest first; the same twice on a border
};

class OrganSurface {
 public:
  explicit OrganSurface(std::vector<geometry::Triangle> triangles);

  /// Takes new positions; the ones before them are kept if a search used them. Positions that are
  /// not finite take the organ out until finite ones come.
  void update(std::span<const Vec3> positions);
  /// Notes that a search used the newest positions.
  void mark_found() { found_ = true; }

  bool present() const { return present_; }
  std::uint64_t version() const { return version_; }
  const std::vector<Vec3>& positions() const { return positions_; }
  /// Where the nodes were in `version`, if that is the one before the newest; else the newest.
  const std::vector<Vec3>& positions_at(std::uint64_t version) const;
  /// Largest distance of a node between positions_at(version) and positions() [m].
  double displacement_since(std::uint64_t version) const;

  const std::vector<geometry::Triangle>& triangles() const { return triangles_; }
  const TriangleBvh& bvh() const { return *bvh_; }
  /// Triangles around a node, ascending.
  std::span<const std::uint32_t> triangles_of_node(std::uint32_t node) const;
  const std::vector<SurfaceEdge>& edges() const { return edges_; }
  const std::array<std::uint32_t, 3>& edges_of_triangle(std::uint32_t triangle) const {
    return edges_of_triangle_[triangle];
  }

 private:
  void build_node_triangles();
  void build_edges();

  std::vector<geometry::Triangle> triangles_;
  std::size_t node_count_ = 0;
  std::vector<std::uint32_t> first_triangle_, node_triangles_;
  std::vector<SurfaceEdge> edges_;
  std::vector<std::array<std::uint32_t, 3>> edges_of_triangle_;
  bool present_ = false, found_ = false;
  std::uint64_t version_ = 0, previous_version_ = 0;
  std::vector<Vec3> positions_, previous_;
  double displacement_ = 0;  ///< [m]
  std::optional<TriangleBvh> bvh_;
};

}  // namespace palpate::collision
