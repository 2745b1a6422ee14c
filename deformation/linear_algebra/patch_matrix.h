// A symmetric matrix of 3×3 blocks over the nodes of a patch, rows one after the other. In float, a
// column to a register.
#pragma once

#include <cstdint>
#include <vector>

#include "deformation/linear_algebra/node_block_matrix.h"
#include "modules/core/aligned_vector.h"
#include "modules/core/simd_vectors.h"

namespace palpate::deformation {

class PatchMatrix {
 public:
  void clear();
  /// A block of the row at work; each once.
  void add(std::uint32_t column, const Block4f& block) { entries_.push_back({column, block}); }
  void end_row();
  Eigen::Matrix3f diagonal(std::size_t row) const;

  std::size_t rows() const { return row_starts_.size() - 1; }

  /// Nodes as the product loads them; their vectors p are for the caller to set.  (rows)
  AlignedVector<WideNode>& nodes() { return nodes_; }

  /// out = A p, in the first rows() of `out`.
  /// @returns p·A p
  double apply(std::vector<Vec4f>& out) const;

 private:
  struct Entry {
    std::uint32_t column;
    Block4f block;
  };
  std::vector<std::uint32_t> row_starts_{0};
  std::vector<Entry, Eigen::aligned_allocator<Entry>> entries_;
  AlignedVector<WideNode> nodes_;
};

}  // namespace palpate::deformation
