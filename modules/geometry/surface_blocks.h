// Blocks of neighbouring triangles, and boxes about them: what is far from a place is told by its
// block without a look at its nodes.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "modules/core/state_archive.h"
#include "modules/geometry/triangle_surface.h"

namespace palpate::geometry {

/// Axis-aligned box, six floats in a row, as wide as floats need to hold its points [m]; empty
/// until something is added.
struct BlockBox {
  std::array<float, 3> lower, upper;

  BlockBox() {
    lower.fill(std::numeric_limits<float>::infinity());
    upper.fill(-std::numeric_limits<float>::infinity());
  }
  void add(const Vec3& point);
  bool operator==(const BlockBox&) const = default;
  void exchange(StateArchive& archive) { archive(lower, upper); }
};

/// So many blocks in a row: SurfaceBlocks::split() puts neighbours there.
inline constexpr std::size_t kBlocksOfGroup = 16;
/// The box of every kBlocksOfGroup boxes in a row.
/// @returns whether all are finite; otherwise the groups are of no use
bool bound_groups(std::span<const BlockBox> boxes, std::vector<BlockBox>& groups);

/// Visits the wanted blocks, ascending; those of a group that is not wanted are not asked about.
/// @param wants_group, wants_block  by index
template <class Group, class Block, class Visit>
void visit_blocks(std::size_t count, const Group& wants_group, const Block& wants_block,
                  const Visit& visit) {
  for (std::size_t first = 0; first < count; first += kBlocksOfGroup) {
    if (!wants_group(first / kBlocksOfGroup)) continue;
    const std::size_t end = std::min(count, first + kBlocksOfGroup);
    for (std::size_t block = first; block < end; ++block) {
      if (wants_block(block)) visit(block);
    }
  }
}

/// Which triangles and nodes belong to each block.
class SurfaceBlocks {
 public:
  static constexpr std::size_t kMostTriangles = 128;

  /// Halves the triangles across the longest extent of their centres until no part has more than
  /// `most`. @returns the block of each triangle, from 0 without gaps
  static std::vector<std::uint32_t> split(std::span<const Vec3> nodes,
                                          std::span<const Triangle> triangles,
                                          std::size_t most = kMostTriangles);

  SurfaceBlocks() = default;
  /// @param block_of_triangle  one per triangle
  SurfaceBlocks(std::span<const Triangle> triangles,
                std::span<const std::uint32_t> block_of_triangle);

  std::size_t count() const { return first_triangle_.empty() ? 0 : first_triangle_.size() - 1; }
  /// Ascending.
  std::span<const std::uint32_t> triangles_of(std::size_t block) const {
    return part(triangles_, first_triangle_, block);
  }
  /// Corners of the block's triangles, ascending, each once.
  std::span<const std::uint32_t> nodes_of(std::size_t block) const {
    return part(nodes_, first_node_, block);
  }

  /// Of triangles_of(), as places in nodes_of().
  std::span<const Triangle> corners_of(std::size_t block) const {
    return std::span(corners_).subspan(first_triangle_[block], triangles_of(block).size());
  }

  /// @param nodes  three floats per node [m]
  BlockBox box_of(std::size_t block, std::span<const float> nodes) const;
  /// The box of every block. @param nodes  doubles or, as on the wire, floats, three per node [m]
  void bound(std::span<const Vec3> nodes, std::vector<BlockBox>& boxes) const;
  void bound(std::span<const float> nodes, std::vector<BlockBox>& boxes) const;

  void exchange(StateArchive& archive) {
    archive(first_triangle_, triangles_, first_node_, nodes_, corners_);
  }

 private:
  static std::span<const std::uint32_t> part(const std::vector<std::uint32_t>& all,
                                             const std::vector<std::uint32_t>& first,
                                             std::size_t block) {
    return std::span(all).subspan(first[block], first[block + 1] - first[block]);
  }

  std::vector<std::uint32_t> first_triangle_, triangles_, first_node_, nodes_;
  std::vector<Triangle> corners_;
};

}  // namespace palpate::geometry
