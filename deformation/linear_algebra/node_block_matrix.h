// A sparse symmetric matrix of 3×3 blocks, one for each pair of nodes that share an element of four
// nodes; both triangles stored, rows one after the other. In float, a column to a register.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "deformation/model/patch.h"
#include "modules/core/simd_vectors.h"

namespace palpate::deformation {

/// A 3×3 block by columns; fourth components are zero.
using Block4f = std::array<Vec4f, 3>;

/// a bᵀ
inline Block4f outer(const Vec4f& a, const Vec4f& b) { return {b[0] * a, b[1] * a, b[2] * a}; }

/// Where the blocks are: one for each ordered pair of nodes that share an element.
struct NodePairs {
  std::vector<std::uint32_t> row_starts;  ///< (node_count + 1)
  std::vector<std::uint32_t> columns;     ///< rising within a row
  std::vector<std::uint32_t> mirrors;     ///< of pair (i, j): where (j, i) is
  std::vector<std::uint32_t> diagonals;   ///< where (i, i) is  (node_count)
  /// Where (node a, node b) of each element is: index 4 a + b.
  std::vector<std::array<std::uint32_t, 16>> of_elements;

  /// @param elements  their nodes
  NodePairs(std::size_t node_count, std::span<const std::array<std::uint32_t, 4>> elements);

  std::size_t node_count() const { return diagonals.size(); }
  std::size_t pair_count() const { return columns.size(); }
};

class NodeBlockMatrix {
 public:
  /// @param pairs  outlives this
  explicit NodeBlockMatrix(const NodePairs& pairs) : pairs_(pairs), blocks_(pairs.pair_count()) {}

  void set_zero();

  /// Adds `block` to the pair there. Only pairs (i, j ≥ i) are looked at before mirror().
  void add(std::uint32_t pair, const Block4f& block) {
    Block4f& sum = blocks_[pair];
    for (std::size_t k = 0; k < 3; ++k) sum[k] += block[k];
  }
  /// Adds scalar · I.
  void add(std::uint32_t pair, float scalar) {
    Block4f& sum = blocks_[pair];
    for (int k = 0; k < 3; ++k) sum[static_cast<std::size_t>(k)][k] += scalar;
  }
  /// Copies the pairs (i, j > i), transposed, to (j, i).
  void mirror();

  Mat3 diagonal(std::size_t node) const;
  const Block4f& block(std::uint32_t pair) const { return blocks_[pair]; }

  /// Adds `share` of the blocks between the nodes of the patch to the lower triangle of `sum`.
  void add_block(const Patch& patch, float share, Eigen::MatrixXf& sum) const;

  /// out = A p. @param p  (node_count)
  void apply(const std::vector<Vec4f>& p, std::vector<Vec4f>& out) const;

 private:
  const NodePairs& pairs_;
  std::vector<Block4f> blocks_;  ///< (pair_count)
};

}  // namespace palpate::deformation
