#include "deformation/linear_algebra/patch_matrix.h"

namespace palpate::deformation {

void PatchMatrix::clear() {
  row_starts_.assign(1, 0);
  entries_.clear();
}

void PatchMatrix::end_row() {
  row_starts_.push_back(static_cast<std::uint32_t>(entries_.size()));
  if (nodes_.size() < rows()) nodes_.resize(rows());
}

Eigen::Matrix3f PatchMatrix::diagonal(std::size_t row) const {
  Eigen::Matrix3f dense = Eigen::Matrix3f::Zero();
  for (auto k = row_starts_[row]; k < row_starts_[row + 1]; ++k) {
    if (entries_[k].column != row) continue;
    for (int c = 0; c < 3; ++c) {
      dense.col(c) = entries_[k].block[static_cast<std::size_t>(c)].head<3>();
    }
  }
  return dense;
}

double PatchMatrix::apply(std::vector<Vec4f>& out) const {
  double dot = 0;
  for (std::size_t i = 0; i < rows(); ++i) {
    Vec4f x = Vec4f::Zero(), y = x, z = x;  // three sums: a chain of additions waits on itself
    for (auto k = row_starts_[i]; k < row_starts_[i + 1]; ++k) {
      const Vec4f& from = nodes_[entries_[k].column].vector;
      const Block4f& block = entries_[k].block;
      x += from[0] * block[0];
      y += from[1] * block[1];
      z += from[2] * block[2];
    }
    out[i] = x + y + z;
    dot += static_cast<double>(nodes_[i].vector.dot(out[i]));
  }
  return dot;
}

}  // namespace palpate::deformation
