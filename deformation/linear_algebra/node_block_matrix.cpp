#include "deformation/linear_algebra/node_block_matrix.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace palpate::deformation {
namespace {

/// The elements of each node, one after the other, and which of their corners it is: 4 element +
/// corner.
struct Corners {
  std::vector<std::uint32_t> starts, of_nodes;

  Corners(std::size_t node_count, std::span<const std::array<std::uint32_t, 4>> elements)
      : starts(node_count + 1, 0), of_nodes(4 * elements.size()) {
    for (const auto& nodes : elements) {
      for (const auto node : nodes) ++starts[node + 1];
    }
    std::partial_sum(starts.begin(), starts.end(), starts.begin());
    std::vector<std::uint32_t> next(starts.begin(), starts.end() - 1);
    for (std::uint32_t e = 0; e < elements.size(); ++e) {
      for (std::uint32_t k = 0; k < 4; ++k) of_nodes[next[elements[e][k]]++] = 4 * e + k;
    }
  }

  std::span<const std::uint32_t> of(std::size_t node) const {
    return std::span(of_nodes).subspan(starts[node], starts[node + 1] - starts[node]);
  }
};

}  // namespace

NodePairs::NodePairs(std::size_t node_count, std::span<const std::array<std::uint32_t, 4>> elements)
    : row_starts(node_count + 1, 0), diagonals(node_count), of_elements(elements.size()) {
  const Corners corners(node_count, elements);
  std::vector<std::uint32_t> row, place(node_count), seen_in(node_count, 0);
  for (std::uint32_t i = 0; i < node_count; ++i) {
    row.assign(1, i);
    seen_in[i] = i + 1;
    for (const std::uint32_t corner : corners.of(i)) {
      for (const std::uint32_t j : elements[corner / 4]) {
        if (std::exchange(seen_in[j], i + 1) != i + 1) row.push_back(j);
      }
    }
    std::ranges::sort(row);
    for (const std::uint32_t j : row) {
      place[j] = static_cast<std::uint32_t>(columns.size());
      columns.push_back(j);
    }
    row_starts[i + 1] = static_cast<std::uint32_t>(columns.size());
    diagonals[i] = place[i];
    for (const std::uint32_t corner : corners.of(i)) {
      const auto& nodes = elements[corner / 4];
      for (std::size_t k = 0; k < 4; ++k) {
        of_elements[corner / 4][4 * (corner % 4) + k] = place[nodes[k]];
      }
    }
  }
  // Rows are gone through in order, so each row's columns are met in theirs.
  std::vector<std::uint32_t> next(row_starts.begin(), row_starts.end() - 1);
  mirrors.reserve(columns.size());
  for (const std::uint32_t column : columns) mirrors.push_back(next[column]++);
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
