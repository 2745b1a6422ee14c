// Which of very many nodes near a round core stand for the others: the nearest in each cell of a
// grid. Floats tell that well enough.
#pragma once

#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "collision/core_sweep.h"

namespace palpate::collision {

using Four = Eigen::Array4f;

/// A node's x, y and z, and something finite.
inline Four row_of(const NodeArray& nodes, std::uint32_t node) {
  const std::size_t first = 3 * std::size_t{node};
  if (first + 3 < nodes.floats().size()) {
    return Eigen::Map<const Four>(nodes.floats().data() + first);
  }
  Four row = Four::Zero();
  row.head<3>() = nodes[node].cast<float>();
  return row;
}

/// A round core where it is at the step's end, in the world.
class CoreAtEnd {
 public:
  /// @param reach  that its distances are asked for [m]
  CoreAtEnd(const RelativeMotion& motion, const Core& core, double reach);

  /// From a node's x, y and z [m²].
  float squared_distance(const Four& x) const {
    const Four from_a = (x - a_) * axes_;
    if (is_point_) return from_a.square().sum();
    const float at = std::clamp((per_length_ * from_a).sum(), 0.0f, 1.0f);
    return (from_a - at * along_).square().sum();
  }
  /// At most that from any node in the box [m²].
  float squared_distance(const geometry::BlockBox& box) const {
    const double at_least = std::sqrt(hull_.squared_distance(box)) - rounding_;
    return static_cast<float>(at_least > 0 ? at_least * at_least : 0);
  }

 private:
  bool is_point_;
  Four axes_{1, 1, 1, 0}, a_ = Four::Zero(), along_ = a_, per_length_ = a_;
  Bounds hull_;
  double rounding_ = 0;  ///< of distances [m]
};

class NodeGrid {
 public:
  /// @param cells  along each axis
  explicit NodeGrid(int cells) : cells_(cells), places_(std::size_t(cells * cells * cells)) {}

  /// The nearest node of a cell, if it has one.
  struct Place {
    float squared = std::numeric_limits<float>::infinity();  ///< distance from the core [m²]
    std::uint32_t node = 0;
    bool is_taken() const { return std::isfinite(squared); }
  };

  /// Begins an empty grid over a box; what is beyond it is in the cells at its border.
  void begin(const Vec3& lower, const Vec3& size);
  /// A node at `x`.
  void take(const Four& x, float squared, std::uint32_t node) {
    Place& nearest = places_[place_of(cell_of(x))];
    if (squared < nearest.squared || (squared == nearest.squared && node < nearest.node)) {
      nearest = {squared, node};
    }
  }
  /// Whether any cell of the box would take something as near.
  bool would_take(const geometry::BlockBox& box, float squared) const;
  std::span<const Place> places() const { return places_; }

 private:
  Eigen::Array4i cell_of(const Four& x) const {
    return ((x - lower_) * per_size_).max(0).min(cells_ - 1).cast<int>();
  }
  std::size_t place_of(const Eigen::Array4i& cell) const {
    return static_cast<std::size_t>((cell[0] * cells_ + cell[1]) * cells_ + cell[2]);
  }

  int cells_;
  Four lower_ = Four::Zero(), per_size_ = Four::Zero();
  std::vector<Place> places_;
};

}  // namespace palpate::collision
