// The newest surface of one organ, and the one before it.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "collision/bounds.h"
#include "collision/node_array.h"
#include "modules/core/state_archive.h"
#include "modules/geometry/closest_points.h"

namespace palpate::collision {

struct SurfaceEdge {
  std::array<std::uint32_t, 2> nodes{};      ///< a < b
  std::array<std::uint32_t, 2> triangles{};  ///< lowest first; the same twice on a border
};

class OrganSurface {
 public:
  using Boxes = std::vector<geometry::BlockBox>;

  /// @param block_of_triangle  see geometry::SurfaceBlocks; empty: made of the first positions
  explicit OrganSurface(std::vector<geometry::Triangle> triangles,
                        std::span<const std::uint32_t> block_of_triangle = {});

  /// Takes new positions; the ones before them are kept if a search used them. Positions that are
  /// not finite take the organ out until finite ones come. A walk over all nodes.
  void update(std::span<const Vec3> positions);
  /// The same with the wire's floats, without a look at any node: positions and boxes are
  /// exchanged with buffers that are free.
  /// @param boxes  of all blocks, as whoever wrote the positions tells them; another number than
  ///               there are blocks: they are made here, which is a walk over all nodes
  void take(std::vector<float>& positions, Boxes& boxes);
  /// Notes that a search used the newest positions.
  void mark_found() { found_ = true; }

  bool present() const { return present_; }
  std::uint64_t version() const { return version_; }
  std::size_t node_count() const { return node_count_; }
  const NodeArray& positions() const { return newest_.positions; }
  /// Where the nodes were in `version`, if that is the one before the newest; else the newest.
  const NodeArray& positions_at(std::uint64_t version) const { return at(version).positions; }
  const Boxes& boxes() const { return newest_.boxes; }
  const Boxes& boxes_at(std::uint64_t version) const { return at(version).boxes; }
  /// See geometry::bound_groups().
  const Boxes& groups() const { return newest_.groups; }
  const Boxes& groups_at(std::uint64_t version) const { return at(version).groups; }
  const geometry::SurfaceBlocks& blocks() const { return blocks_; }

  /// Of all triangles.
  Bounds bounds() const;
  /// Appends the triangles whose own bounds overlap `box`, block by block.
  void append_overlapping(const Bounds& box, std::vector<std::uint32_t>& triangles) const;

  const std::vector<geometry::Triangle>& triangles() const { return triangles_; }
  geometry::TriangleCorners corners(std::uint32_t triangle) const {
    const geometry::Triangle& nodes = triangles_[triangle];
    return {positions()[nodes[0]], positions()[nodes[1]], positions()[nodes[2]]};
  }
  /// Triangles around a node, ascending.
  std::span<const std::uint32_t> triangles_of_node(std::uint32_t node) const;
  const std::vector<SurfaceEdge>& edges() const { return edges_; }
  const std::array<std::uint32_t, 3>& edges_of_triangle(std::uint32_t triangle) const {
    return edges_of_triangle_[triangle];
  }

  /// Of the same triangles and blocks.
  void exchange(StateArchive& archive) {
    archive(blocks_, present_, found_, version_, previous_version_, newest_, previous_);
  }

 private:
  struct Shape {
    NodeArray positions;
    Boxes boxes, groups;  ///< by block, and of blocks
    void exchange(StateArchive& archive) { archive(positions, boxes, groups); }
  };

  void build_node_triangles();
  void build_edges();
  /// Keeps the newest shape if a search used it.
  void begin_update(bool finite);
  void split();
  const Shape& at(std::uint64_t version) const {
    return version > 0 && version == previous_version_ ? previous_ : newest_;
  }

  std::vector<geometry::Triangle> triangles_;
  std::size_t node_count_ = 0;
  std::vector<std::uint32_t> first_triangle_, node_triangles_;
  std::vector<SurfaceEdge> edges_;
  std::vector<std::array<std::uint32_t, 3>> edges_of_triangle_;
  geometry::SurfaceBlocks blocks_;
  bool present_ = false, found_ = false;
  std::uint64_t version_ = 0, previous_version_ = 0;
  Shape newest_, previous_;
  Boxes groups_;  ///< buffer
};

}  // namespace palpate::collision
