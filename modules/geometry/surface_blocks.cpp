#include "modules/geometry/surface_blocks.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>

#include "modules/core/error.h"

namespace palpate::geometry {
namespace {

/// As std::nextafter(x, -∞), which is a call. x may not be -∞, or no number.
float next_below(float x) {
  if (x == 0) return -std::numeric_limits<float>::denorm_min();
  const auto bits = std::bit_cast<std::uint32_t>(x);
  return std::bit_cast<float>(x > 0 ? bits - 1 : bits + 1);
}
float rounded_down(double x) {
  const float nearest = static_cast<float>(x);
  return nearest > x ? next_below(nearest) : nearest;
}
float rounded_up(double x) { return -rounded_down(-x); }

/// Halves triangles again and again.
class Splitter {
 public:
  Splitter(std::span<const Vec3> nodes, std::span<const Triangle> triangles, std::size_t most)
      : most_(most), order_(triangles.size()), block_(triangles.size()) {
    std::iota(order_.begin(), order_.end(), 0u);
    for (const auto& [a, b, c] : triangles) centres_.push_back(nodes[a] + nodes[b] + nodes[c]);
    if (!order_.empty()) split(order_);
  }
  std::vector<std::uint32_t> take() { return std::move(block_); }

 private:
  void split(std::span<std::uint32_t> part) {
    if (part.size() <= most_) {
      for (const std::uint32_t t : part) block_[t] = count_;
      ++count_;
      return;
    }
    Vec3 lower = centres_[part.front()], upper = lower;
    for (const std::uint32_t t : part) {
      lower = lower.cwiseMin(centres_[t]);
      upper = upper.cwiseMax(centres_[t]);
    }
    Eigen::Index axis = 0;
    (upper - lower).maxCoeff(&axis);
    const std::size_t half = part.size() / 2;
    std::nth_element(part.begin(), part.begin() + static_cast<std::ptrdiff_t>(half), part.end(),
                     [&](std::uint32_t a, std::uint32_t b) {
                       return std::pair(centres_[a][axis], a) < std::pair(centres_[b][axis], b);
                     });
    split(part.first(half));
    split(part.subspan(half));
  }

  const std::size_t most_;
  std::vector<Vec3> centres_;  ///< of each triangle, times three
  std::vector<std::uint32_t> order_, block_;
  std::uint32_t count_ = 0;
};

}  // namespace

void BlockBox::add(const Vec3& point) {
  for (int k = 0; k < 3; ++k) {
    lower[k] = std::min(lower[k], rounded_down(point[k]));
    upper[k] = std::max(upper[k], rounded_up(point[k]));
  }
}

bool bound_groups(std::span<const BlockBox> boxes, std::vector<BlockBox>& groups) {
  using Four = Eigen::Map<const Eigen::Array4f>;  // a box is six floats in a row
  constexpr float kFar = std::numeric_limits<float>::infinity();
  groups.resize((boxes.size() + kBlocksOfGroup - 1) / kBlocksOfGroup);
  Eigen::Array4f rest = Eigen::Array4f::Zero();  // of what is not finite, no number
  for (BlockBox& group : groups) {
    const auto own = boxes.first(std::min(kBlocksOfGroup, boxes.size()));
    boxes = boxes.subspan(own.size());
    Eigen::Array4f lower = Eigen::Array4f::Constant(kFar), upper = -lower;
    for (const BlockBox& box : own) {
      const Four first(box.lower.data()), last(box.lower.data() + 2);
      lower = lower.min(first);
      upper = upper.max(last);
      rest += (first - first) + (last - last);
    }
    std::copy_n(lower.data(), 3, group.lower.data());
    std::copy_n(upper.data() + 1, 3, group.upper.data());
  }
  return (rest == 0).all();
}

std::vector<std::uint32_t> SurfaceBlocks::split(std::span<const Vec3> nodes,
                                                std::span<const Triangle> triangles,
                                                std::size_t most) {
  return Splitter(nodes, triangles, most).take();
}

SurfaceBlocks::SurfaceBlocks(std::span<const Triangle> triangles,
                             std::span<const std::uint32_t> block_of_triangle) {
  PALPATE_DEMAND(block_of_triangle.size() == triangles.size());
  std::uint32_t blocks = 0;
  for (const std::uint32_t block : block_of_triangle) blocks = std::max(blocks, block + 1);
  first_triangle_.assign(blocks + 1, 0);
  for (const std::uint32_t block : block_of_triangle) ++first_triangle_[block + 1];
  std::partial_sum(first_triangle_.begin(), first_triangle_.end(), first_triangle_.begin());
  triangles_.resize(triangles.size());
  std::vector<std::uint32_t> next = first_triangle_, own;
  std::uint32_t last = 0;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    triangles_[next[block_of_triangle[t]]++] = t;
    for (const std::uint32_t node : triangles[t]) last = std::max(last, node);
  }
  constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> place(std::size_t{last} + 1, kNone);  // of a node in its block
  corners_.reserve(triangles.size());
  first_node_.push_back(0);
  for (std::uint32_t block = 0; block < blocks; ++block) {
    own.clear();
    for (const std::uint32_t t : triangles_of(block)) {
      for (const std::uint32_t node : triangles[t]) {
        if (std::exchange(place[node], 0) == kNone) own.push_back(node);
      }
    }
    std::ranges::sort(own);
    for (std::uint32_t i = 0; i < own.size(); ++i) place[own[i]] = i;
    for (const std::uint32_t t : triangles_of(block)) {
      const auto& [a, b, c] = triangles[t];
      corners_.push_back({place[a], place[b], place[c]});
    }
    for (const std::uint32_t node : own) place[node] = kNone;
    nodes_.insert(nodes_.end(), own.begin(), own.end());
    first_node_.push_back(static_cast<std::uint32_t>(nodes_.size()));
  }
}

void SurfaceBlocks::bound(std::span<const Vec3> nodes, std::vector<BlockBox>& boxes) const {
  boxes.resize(count());
  for (std::size_t block = 0; block < boxes.size(); ++block) {
    const auto own = nodes_of(block);
    boxes[block] = BlockBox();
    if (own.empty()) continue;
    Vec3 lower = nodes[own.front()], upper = lower;
    for (const std::uint32_t node : own) {
      lower = lower.cwiseMin(nodes[node]);
      upper = upper.cwiseMax(nodes[node]);
    }
    boxes[block].add(lower);
    boxes[block].add(upper);
  }
}

BlockBox SurfaceBlocks::box_of(std::size_t block, std::span<const float> nodes) const {
  BlockBox box;
  for (const std::uint32_t node : nodes_of(block)) {
    for (std::size_t k = 0; k < 3; ++k) {
      box.lower[k] = std::min(box.lower[k], nodes[3 * node + k]);
      box.upper[k] = std::max(box.upper[k], nodes[3 * node + k]);
    }
  }
  return box;
}

void SurfaceBlocks::bound(std::span<const float> nodes, std::vector<BlockBox>& boxes) const {
  boxes.resize(count());
  for (std::size_t block = 0; block < boxes.size(); ++block) boxes[block] = box_of(block, nodes);
}

}  // namespace palpate::geometry
