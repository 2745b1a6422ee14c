// Which corners of a sharp probe are looked at with which triangles of an organ in a step.
//
// Each corner is looked at with all that it may come to. Where that is too much, as of finely
// meshed tools, pairs are left out, the least needed first: far parts of the walls that corners are
// behind, of each triangle the corners that are not nearest to it, and triangles beside the way
// ahead. What a corner outside may go past in the step is left out last, and said.
#pragma once

#include <span>
#include <vector>

#include "collision/core_contacts.h"
#include "collision/probe_model.h"
#include "modules/core/sort_unique.h"

namespace palpate::collision {

class CornerPairs {
 public:
  /// Beyond so many pairs, and so many with each triangle, not all are looked at.
  static constexpr std::size_t kManyPairs = 65536, kFewestOfEach = 16;
  /// A tool of so few corners is looked at with all triangles however many they are.
  static constexpr std::size_t kFewCorners = 128;
  /// Of corners that may have gone past a triangle so many pairs.
  static constexpr std::size_t kMostPassed = 262144;
  /// Of corners behind walls so many pairs with their walls' triangles, and kLeastWall of each.
  static constexpr std::size_t kManyWallPairs = 8192, kLeastWall = 16;

  /// A corner, or a line behind a wall, and a triangle.
  using Pair = std::pair<std::uint32_t, std::uint32_t>;

  /// Begins with the corners and lines that are behind walls, whose triangles are appended.
  void hold(const OrganStep& step, const ProbeModel& probe, CoreContacts& cores,
            std::vector<std::uint32_t>& triangles);

  /// Whether a tool of many corners comes to more than kManyPairs, even with kFewestOfEach for each
  /// triangle: then fewer triangles are to be near.
  bool are_too_many(const OrganStep& step, const ProbeModel& probe,
                    std::span<const SweptTriangle> triangles);
  /// All pairs, by corner, with places in a list of triangles.
  /// @param triangles  near the probe, and those of hold(); ascending
  void list(const OrganStep& step, const ProbeModel& probe,
            std::span<const SweptTriangle> triangles);
  std::span<const Pair> pairs() const { return pairs_; }
  /// More corners than kMostPassed may have gone past triangles.
  bool was_cut() const { return was_cut_; }

 private:
  bool list_near(const OrganStep& step, const SharpMesh& probe,
                 std::span<const SweptTriangle> triangles);
  std::size_t add_near(const OrganStep& step, const SharpMesh& probe, const SweptTriangle& triangle,
                       double beside, std::uint32_t place);
  void list_nearest(const OrganStep& step, const SharpMesh& probe,
                    std::span<const SweptTriangle> triangles);
  void add_walls(std::span<const SweptTriangle> triangles);

  std::vector<Pair> pairs_;
  bool was_cut_ = false;
  // Kept between calls for their memory only.
  std::vector<std::uint32_t> held_, near_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> wall_pairs_;  ///< corner, triangle
  PairSorter<Pair> sorter_;
};

}  // namespace palpate::collision
