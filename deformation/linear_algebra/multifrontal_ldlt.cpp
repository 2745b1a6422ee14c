#include "deformation/linear_algebra/multifrontal_ldlt.h"

#include <algorithm>
#include <cmath>

#include "modules/core/error.h"

namespace palpate::deformation {
namespace {

/// Fewer, and fronts are too small for dense work; more, and zeros are multiplied.
constexpr std::size_t kLeafElements = 8;
constexpr Eigen::Index kPanel = 48;

/// L D Lᵀ of a small symmetric matrix in place: L below the diagonal, D on it.
bool factor_diagonal_block(Eigen::Ref<Eigen::MatrixXd> a) {
  const Eigen::Index n = a.rows();
  for (Eigen::Index j = 0; j < n; ++j) {
    const double pivot = a(j, j);
    if (!std::isfinite(pivot) || pivot == 0) return false;
    const Eigen::Index rest = n - j - 1;
    const Eigen::VectorXd column = a.col(j).tail(rest);
    a.col(j).tail(rest) /= pivot;
    for (Eigen::Index k = 0; k < rest; ++k) {
      a.col(j + 1 + k).tail(rest - k) -= column[k] * a.col(j).tail(rest - k);
    }
  }
  return true;
}

/// Eliminates the first columns of the lower triangle of a, panel by panel; the rest becomes the
/// Schur complement.
bool eliminate(Eigen::MatrixXd& a, Eigen::Index count) {
  const Eigen::Index size = a.rows();
  for (Eigen::Index begin = 0; begin < count; begin += kPanel) {
    const Eigen::Index width = std::min(kPanel, count - begin), end = begin + width;
    auto block = a.block(begin, begin, width, width);
    if (!factor_diagonal_block(block)) return false;
    auto below = a.block(end, begin, size - end, width);
    // below = L D Lᵀ_block  ⇒  L = below L⁻ᵀ D⁻¹
    block.triangularView<Eigen::UnitLower>().transpose().solveInPlace<Eigen::OnTheRight>(below);
    const Eigen::MatrixXd scaled = below;
    below = scaled * block.diagonal().cwiseInverse().asDiagonal();
    for (Eigen::Index c = end; c < size; c += 2 * kPanel) {
      const Eigen::Index columns = std::min(2 * kPanel, size - c);
      a.block(c, c, size - c, columns).noalias() -=
          below.bottomRows(size - c) * scaled.middleRows(c - end, columns).transpose();
    }
  }
  return true;
}

}  // namespace

MultifrontalLdlt::MultifrontalLdlt(std::size_t dof_count, std::vector<std::vector<int>> dofs,
                                   std::vector<Vec3> centres)
    : dof_count_(dof_count),
      dofs_(std::move(dofs)),
      centres_(std::move(centres)),
      use_counts_(dof_count, 0),
      marks_(dof_count, 0),
      places_(dof_count, 0) {
  PALPATE_DEMAND(dofs_.size() == centres_.size());
  for (const auto& element : dofs_) {
    for (const int dof : element) {
      if (dof >= 0) ++use_counts_[static_cast<std::size_t>(dof)];
    }
  }
  std::vector<std::size_t> elements(dofs_.size());
  for (std::size_t e = 0; e < elements.size(); ++e) elements[e] = e;
  build(elements);
}

/// Orders the elements so that the returned number of them come first: the halving, across x, y or
/// z, with the fewest common unknowns.
std::size_t MultifrontalLdlt::split(std::span<std::size_t> elements) {
  const std::size_t half = elements.size() / 2;
  std::vector<std::size_t> best;
  std::size_t fewest = 0;
  for (int axis = 0; axis < 3; ++axis) {
    std::nth_element(elements.begin(), elements.begin() + static_cast<std::ptrdiff_t>(half),
                     elements.end(), [&](std::size_t a, std::size_t b) {
                       const double x = centres_[a][axis], y = centres_[b][axis];
                       return x < y || (x == y && a < b);
                     });
    const int first = ++mark_, counted = ++mark_;
    std::size_t common = 0;
    for (std::size_t i = 0; i < elements.size(); ++i) {
      for (const int dof : dofs_[elements[i]]) {
        if (dof < 0) continue;
        int& mark = marks_[static_cast<std::size_t>(dof)];
        if (i < half) {
          mark = first;
        } else if (mark == first) {
          mark = counted;
          ++common;
        }
      }
    }
    if (best.empty() || common < fewest) {
      best.assign(elements.begin(), elements.end());
      fewest = common;
    }
  }
  std::copy(best.begin(), best.end(), elements.begin());
  return half;
}

/// @returns the unknowns that wait, ascending, with the number of elements they have met
std::vector<MultifrontalLdlt::DofUse> MultifrontalLdlt::build(std::span<std::size_t> elements) {
  Front front;
  std::vector<DofUse> uses;
  if (elements.size() > kLeafElements) {
    const std::size_t half = split(elements);
    uses = build(elements.first(half));
    front.children[0] = static_cast<int>(fronts_.size()) - 1;
    const auto other = build(elements.subspan(half));
    front.children[1] = static_cast<int>(fronts_.size()) - 1;
    uses.insert(uses.end(), other.begin(), other.end());
  } else {
    front.elements.assign(elements.begin(), elements.end());
    for (const std::size_t e : elements) {
      for (const int dof : dofs_[e]) {
        if (dof >= 0) uses.push_back({dof, 1});
      }
    }
  }
  add_front(uses, std::move(front));
  return uses;
}

/// Joins equal unknowns; those that have met all their elements are eliminated in `front` and taken
/// out of `uses`.
void MultifrontalLdlt::add_front(std::vector<DofUse>& uses, Front front) {
  std::sort(uses.begin(), uses.end(),
            [](const DofUse& a, const DofUse& b) { return a.dof < b.dof; });
  std::vector<DofUse> joined;
  for (const DofUse& use : uses) {
    if (!joined.empty() && joined.back().dof == use.dof) {
      joined.back().elements += use.elements;
    } else {
      joined.push_back(use);
    }
  }
  uses.clear();
  for (const DofUse& use : joined) {
    if (use.elements == use_counts_[static_cast<std::size_t>(use.dof)]) {
      front.dofs.push_back(use.dof);
    } else {
      uses.push_back(use);
    }
  }
  front.eliminated = static_cast<Eigen::Index>(front.dofs.size());
  for (const DofUse& use : uses) front.dofs.push_back(use.dof);
  fronts_.push_back(std::move(front));
}

void MultifrontalLdlt::assemble(const MatrixOf& matrix_of, Front& front, Eigen::MatrixXd& matrix) {
  const auto size = static_cast<Eigen::Index>(front.dofs.size());
  matrix.setZero(size, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    places_[static_cast<std::size_t>(front.dofs[static_cast<std::size_t>(i)])] = i;
  }
  const auto add = [&](int row_dof, int column_dof, double value) {
    const auto i = places_[static_cast<std::size_t>(row_dof)];
    const auto j = places_[static_cast<std::size_t>(column_dof)];
    matrix(std::max(i, j), std::min(i, j)) += value;
  };
  for (const std::size_t e : front.elements) {
    const Eigen::Ref<const Eigen::MatrixXd> local = matrix_of(e);
    const std::vector<int>& dofs = dofs_[e];
    for (std::size_t j = 0; j < dofs.size(); ++j) {
      for (std::size_t i = j; i < dofs.size(); ++i) {
        if (dofs[i] < 0 || dofs[j] < 0) continue;
        add(dofs[i], dofs[j], local(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)));
      }
    }
  }
  for (const int c : front.children) {
    if (c < 0) continue;
    Front& child = fronts_[static_cast<std::size_t>(c)];
    const int* dofs = child.dofs.data() + child.eliminated;
    for (Eigen::Index j = 0; j < child.waiting.cols(); ++j) {
      for (Eigen::Index i = j; i < child.waiting.rows(); ++i) {
        add(dofs[i], dofs[j], child.waiting(i, j));
      }
    }
    child.waiting.resize(0, 0);
  }
}

bool MultifrontalLdlt::factor(const MatrixOf& matrix_of) {
  Eigen::MatrixXd matrix;
  for (Front& front : fronts_) {
    assemble(matrix_of, front, matrix);
    if (!eliminate(matrix, front.eliminated)) return false;
    front.columns = matrix.leftCols(front.eliminated);
    front.pivots = matrix.diagonal().head(front.eliminated);
    const Eigen::Index waiting = matrix.rows() - front.eliminated;
    front.waiting = matrix.bottomRightCorner(waiting, waiting);
  }
  return true;
}

void MultifrontalLdlt::solve(Eigen::Ref<Eigen::MatrixXd> b) const {
  PALPATE_DEMAND(b.rows() == static_cast<Eigen::Index>(dof_count_));
  for (std::size_t d = 0; d < dof_count_; ++d) {
    if (use_counts_[d] == 0) b.row(static_cast<Eigen::Index>(d)).setZero();
  }
  for (const Front& front : fronts_) {  // L y = b, y ← D⁻¹ y
    const std::span all(front.dofs);
    const auto own = all.first(static_cast<std::size_t>(front.eliminated));
    const auto waiting = all.subspan(own.size());
    Eigen::MatrixXd y = b(own, Eigen::all);
    front.columns.topRows(front.eliminated).triangularView<Eigen::UnitLower>().solveInPlace(y);
    b(waiting, Eigen::all) -= front.columns.bottomRows(front.columns.rows() - front.eliminated) * y;
    b(own, Eigen::all) = front.pivots.cwiseInverse().asDiagonal() * y;
  }
  for (auto front = fronts_.rbegin(); front != fronts_.rend(); ++front) {  // Lᵀ x = y
    const std::span all(front->dofs);
    const auto own = all.first(static_cast<std::size_t>(front->eliminated));
    const Eigen::MatrixXd later = b(all.subspan(own.size()), Eigen::all);
    Eigen::MatrixXd y = b(own, Eigen::all);
    y.noalias() -=
        front->columns.bottomRows(front->columns.rows() - front->eliminated).transpose() * later;
    front->columns.topRows(front->eliminated)
        .triangularView<Eigen::UnitLower>()
        .transpose()
        .solveInPlace(y);
    b(own, Eigen::all) = y;
  }
}

std::size_t MultifrontalLdlt::negative_pivots() const {
  std::size_t count = 0;
  for (const Front& front : fronts_) {
    count += static_cast<std::size_t>((front.pivots.array() < 0).count());
  }
  return count;
}

}  // namespace palpate::deformation
