// Features of deforming surfaces that are near each other: nodes with triangles and edges with
// edges, of two organs or of one organ with itself. Two surfaces of triangles can only meet by such
// a pair. Which side of a surface is outside does not matter here: surfaces that never met are kept
// apart along the direction between the pair.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "collision/organ_surface.h"
#include "modules/geometry/continuous_collision.h"

namespace palpate::collision {

using geometry::FourPoints;

/// Node–triangle: nodes[0] of surfaces[0], nodes[1…3] of surfaces[1]. Edge–edge: nodes[0…1] of
/// surfaces[0], nodes[2…3] of surfaces[1].
struct FeaturePair {
  std::array<std::uint32_t, 2> surfaces{};
  bool is_edges = false;
  std::array<std::uint32_t, 4> nodes{};

  std::size_t first_count() const { return is_edges ? 2 : 1; }  ///< nodes of surfaces[0]
  std::uint32_t surface_of(std::size_t k) const { return surfaces[k < first_count() ? 0 : 1]; }
  auto operator<=>(const FeaturePair&) const = default;
};

/// The closest points of a pair.
struct Separation {
  double distance = 0;              ///< [m]
  Vec3 direction = Vec3::Zero();    ///< unit, from the first to the second; zero where they meet
  std::array<double, 4> weights{};  ///< of the nodes; each side's are ≥ 0 and sum to 1
};

Separation separation_of(bool is_edges, const FourPoints& points);

/// Whether the pair, moving linearly, stays further apart than `least` or than it was at the start.
/// First by a plane: the gap of two sides along a fixed direction is a concave function of time,
/// so that what is apart at both ends never met. Where that fails, by continuous collision
/// detection, which errs on the side of a meeting.
/// @param at_start  separation_of(start)
bool stays_apart(bool is_edges, const FourPoints& start, const FourPoints& end,
                 const Separation& at_start, double least);

struct NearPair {
  FeaturePair pair;
  double distance = 0;  ///< when searched [m]
};

/// Surfaces that may touch.
struct TouchingKinds {
  bool others = false;  ///< each with each other
  bool itself = false;  ///< each with itself
};

class NearFeatures {
 public:
  NearFeatures(std::vector<std::vector<geometry::Triangle>> triangles, const TouchingKinds& kinds);

  /// Finds all pairs no further apart than `reach` [m], in order. Features of one surface that
  /// share a node are no pair.
  /// @param positions  by surface [m]  (at least its nodes)
  void search(std::span<const std::span<const Vec3>> positions, double reach);

  const std::vector<NearPair>& pairs() const { return pairs_; }
  /// At the last search.
  std::span<const Vec3> positions(std::size_t surface) const {
    return surfaces_[surface].positions().doubles();
  }

  /// Two surfaces, or one twice, that pass through each other as they were at the last search.
  std::optional<std::array<std::uint32_t, 2>> first_crossing() const;

 private:
  bool may_touch(std::size_t a, std::size_t b) const {
    return a == b ? kinds_.itself : kinds_.others;
  }
  /// Nodes and edges that belong to each block: each to that of its first triangle.
  struct BlockFeatures {
    std::vector<std::vector<std::uint32_t>> nodes, edges;
  };
  struct Boxed {
    std::uint32_t index = 0;
    Bounds box;
  };
  struct Block {
    std::uint32_t surface = 0, index = 0;
  };
  struct BlockAlongX {
    double lower = 0;  ///< of its box, less the reach [m]
    Block block;
  };

  void make_blocks(std::span<const std::span<const Vec3>> positions);
  void search_pair(std::uint32_t first, std::uint32_t second, double reach);
  Bounds box_of(const Block& block, double reach) const;
  void list_nodes(const Block& of, const Bounds& within, double reach);
  void list_triangles(const Block& of, const Bounds& within);
  void list_edges(const Block& of, const Bounds& within, double reach, std::vector<Boxed>& list);
  void add_nodes(const Block& of, const Block& with, double reach);
  void add_edges(const Block& first, const Block& second, double reach);
  void add_if_near(const FeaturePair& pair, double reach);
  bool cross(std::uint32_t first, std::uint32_t second) const;

  TouchingKinds kinds_;
  std::vector<OrganSurface> surfaces_;
  std::vector<NearPair> pairs_;
  std::vector<BlockFeatures> features_;  ///< by surface
  // Kept between calls for their memory only.
  std::vector<BlockAlongX> along_x_;
  std::vector<Boxed> ones_, others_;
};

}  // namespace palpate::collision
