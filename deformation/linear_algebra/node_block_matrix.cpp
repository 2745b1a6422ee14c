#include "deformation/linear_algebra/node_block_matrix.h"

#include <algorithm>

#include "modules/core/sort_unique.h"

namespace palpate::deformation {
namespace {

std::vector<std::vector<std::uint32_t>> nodes_sharing_elements(
    std::size_t node_count, std::span<const std::array<std::uint32_t, 4>> elements) {
  std::vector<std::vector<std::uint32_t>> neighbours(node_count);
  for (std::uint32_t i = 0; i < node_count; ++i) neighbours[i].push_back(i);
  for (const auto& nodes : elements) {
    for (const auto a : nodes) {
      for (const auto b : nodes) neighbours[a].push_back(b);
    }
  }
  for (auto& row : neighbours) sort_unique(row);
  return neighbours;
}

}  // namespace

NodePairs::NodePairs(std::size_t node_count,
                     std::span<const std::array<std::uint32_t, 4>> elements) {
  row_starts.push_back(0);
  for (const auto& row : nodes_sharing_elements(node_count, elements)) {
    columns.insert(columns.end(), row.begin(), row.end());
    row_starts.push_back(static_cast<std::uint32_t>(columns.size()));
  }
  const auto find = [&](std::uint32_t i, std::uint32_t j) {
    const auto end = columns.begin() + row_starts[i + 1];
    const auto at = std::lower_bound(columns.begin() + row_starts[i], end, j);
    return static_cast<std::uint32_t>(at - columns.begin());
  };
  for (std::uint32_t i = 0; i < node_count; ++i) {
    diagonals.push_back(find(i, i));
    for (auto k = row_starts[i]; k < row_starts[i + 1]; ++k) mirrors.push_back(find(columns[k], i));
  }
  for (const auto& nodes : elements) {
    auto& pairs = of_elements.emplace_back();
    for (std::size_t k = 0; k < 16; ++k) pairs[k] = find(nodes[k / 4], nodes[k % 4]);
  }
}

void NodeBlockMatrix::set_zero() {
  std::fill(blocks_.begin(), blocks_.end(), Block4f{Vec4f::Zero(), Vec4f::Zero(), Vec4f::Zero()});
}

void NodeBlockMatrix::mirror() {
  for (std::size_t i = 0; i < pairs_.node_count(); ++i) {
    for (auto k = pairs_.diagonals[i] + 1; k < pairs_.row_starts[i + 1]; ++k) {
      const Block4f& from = blocks_[k];
      Block4f& to = blocks_[pairs_.mirrors[k]];
      for (int c = 0; c < 3; ++c) {
        to[static_cast<std::size_t>(c)] = Vec4f(from[0][c], from[1][c], from[2][c], 0);
      }
    }
  }
}

Mat3 NodeBlockMatrix::diagonal(std::size_t node) const {
  const Block4f& block = blocks_[pairs_.diagonals[node]];
  Mat3 dense;
  for (int c = 0; c < 3; ++c) {
    dense.col(c) = block[static_cast<std::size_t>(c)].head<3>().cast<double>();
  }
  return dense;
}

void NodeBlockMatrix::add_block(const Patch& patch, float share, Eigen::MatrixXf& sum) const {
  for (const std::uint32_t node : patch.nodes) {
    const int i = patch.place(node);
    for (auto k = pairs_.row_starts[node]; k < pairs_.row_starts[node + 1]; ++k) {
      const int j = patch.place(pairs_.columns[k]);
      if (j < 0 || j > i) continue;
      for (int c = 0; c < 3; ++c) {
        sum.block<3, 1>(3 * i, 3 * j + c) +=
            share * blocks_[k][static_cast<std::size_t>(c)].head<3>();
      }
    }
  }
}

void NodeBlockMatrix::apply(const std::vector<Vec4f>& p, std::vector<Vec4f>& out) const {
  for (std::size_t i = 0; i < pairs_.node_count(); ++i) {
    Vec4f x = Vec4f::Zero(), y = x, z = x;  // three sums: a chain of additions waits on itself
    for (auto k = pairs_.row_starts[i]; k < pairs_.row_starts[i + 1]; ++k) {
      const Vec4f& from = p[pairs_.columns[k]];
      const Block4f& block = blocks_[k];
      x += from[0] * block[0];
      y += from[1] * block[1];
      z += from[2] * block[2];
    }
    out[i] = x + y + z;
  }
}

}  // namespace palpate::deformation
