#include "deformation/linear_algebra/multifrontal_ldlt.h"

#include <algorithm>
#include <cmath>

#include "deformation/linear_algebra/dense_product.h"
#include "modules/core/error.h"

namespace palpate::deformation {
namespace {

/// Fewer, and fronts are too small for dense work; more, and zeros are multiplied.
constexpr std::size_t kLeafElements = 8;
constexpr Eigen::Index kPanel = 64, kBlock = 16;
/// Of a product: strips of that many columns stay in the second cache.
constexpr Eigen::Index kDepth = 256;

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

/// X ← X L⁻ᵀ, block by block, so that most of it is products.
void solve_on_the_right(const DenseProduct::ConstBlock& lower, DenseProduct::Block x,
                        DenseProduct& product) {
  const Eigen::Index width = lower.cols();
  for (Eigen::Index begin = 0; begin < width; begin += kBlock) {
    const Eigen::Index count = std::min(kBlock, width - begin), end = begin + count;
    auto block = x.middleCols(begin, count);
    lower.block(begin, begin, count, count)
        .triangularView<Eigen::UnitLower>()
        .transpose()
        .solveInPlace<Eigen::OnTheRight>(block);
    product.subtract(block, lower.block(end, begin, width - end, count), x.rightCols(width - end));
  }
}

/// Eliminates all columns of the lower trapezium `a`, panel by panel: L D afterwards in `scaled`
/// below each panel, L and D in `a`.
bool eliminate(Eigen::MatrixXd& a, Eigen::MatrixXd& scaled, DenseProduct& product,
               const std::function<void()>& keep_going) {
  const Eigen::Index size = a.rows(), count = a.cols();
  for (Eigen::Index begin = 0; begin < count; begin += kPanel) {
    keep_going();
    const Eigen::Index width = std::min(kPanel, count - begin), end = begin + width;
    auto block = a.block(begin, begin, width, width);
    if (!factor_diagonal_block(block)) return false;
    auto below = a.block(end, begin, size - end, width);
    // below = L D Lᵀ_block  ⇒  L = below L⁻ᵀ D⁻¹
    solve_on_the_right(block, below, product);
    const auto scaled_below = scaled.block(end, begin, size - end, width);
    scaled.block(end, begin, size - end, width) = below;
    below = scaled_below * block.diagonal().cwiseInverse().asDiagonal();
    product.subtract_lower(below, scaled_below.topRows(count - end),
                           a.block(end, end, size - end, count - end));
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
  stack_size_ = std::max(stack_size_, stacked_ + uses.size() * uses.size());
  for (const int child : front.children) {
    if (child < 0) continue;
    const std::size_t left = fronts_[static_cast<std::size_t>(child)].waiting_dofs().size();
    stacked_ -= left * left;
  }
  stacked_ += uses.size() * uses.size();
  fronts_.push_back(std::move(front));
}

/// Adds one column of a part of the front at hand, rows `begin` and later, to where they belong.
void MultifrontalLdlt::Sum::add_column(std::span<const Eigen::Index> places, std::size_t begin,
                                       const double* values) {
  const Eigen::Index column = places[begin];
  if (column < 0) return;
  const bool is_own = column < own.cols();
  const Eigen::Index skipped = is_own ? 0 : own.cols();
  double* into = is_own ? &own(0, column) : &waiting(0, column - skipped);
  for (std::size_t i = begin; i < places.size(); ++i) {
    const Eigen::Index row = places[i];
    if (row >= column) {
      into[row - skipped] += values[i];
    } else if (row >= 0 && row < own.cols()) {
      own(column, row) += values[i];
    } else if (row >= 0) {
      waiting(column - own.cols(), row - own.cols()) += values[i];
    }
  }
}

/// Adds all of a child. Its unknowns ascend, so those eliminated here do, and those that wait.
void MultifrontalLdlt::Sum::add_child(std::span<const Eigen::Index> places, const double* values) {
  const std::size_t count = places.size();
  std::vector<std::size_t> eliminated, left;  // of the child's
  for (std::size_t i = 0; i < count; ++i) {
    if (places[i] < own.cols()) {
      eliminated.push_back(i);
    } else {
      left.push_back(i);
    }
  }
  for (const std::size_t j : eliminated) {  // where they belong all rows are below
    const double* const from = values + j * count;
    double* const into = &own(0, places[j]);
    for (std::size_t i = j; i < count; ++i) into[places[i]] += from[i];
  }
  auto own_below = eliminated.begin();
  for (std::size_t k = 0; k < left.size(); ++k) {
    const std::size_t j = left[k];
    const double* const from = values + j * count;
    const Eigen::Index skipped = own.cols();
    double* const into = &waiting(0, places[j] - skipped);
    for (const std::size_t i : std::span(left).subspan(k)) into[places[i] - skipped] += from[i];
    while (own_below != eliminated.end() && *own_below < j) ++own_below;
    for (auto i = own_below; i != eliminated.end(); ++i) own(places[j], places[*i]) += from[*i];
  }
}

/// The front's sum of its elements and of what its children left, the last on the stack.
/// @param children  behind the last of it
void MultifrontalLdlt::assemble(const MatrixOf& matrix_of, const Front& front,
                                const double* children, Sum sum) {
  sum.own.setZero();
  const Eigen::Index waiting = sum.waiting.cols();
  for (Eigen::Index j = 0; j < waiting; ++j) sum.waiting.col(j).tail(waiting - j).setZero();
  for (std::size_t i = 0; i < front.dofs.size(); ++i) {
    places_[static_cast<std::size_t>(front.dofs[i])] = static_cast<Eigen::Index>(i);
  }
  std::vector<Eigen::Index> places;
  const auto look_up = [&](std::span<const int> dofs) {
    places.clear();
    for (const int dof : dofs) {
      places.push_back(dof < 0 ? -1 : places_[static_cast<std::size_t>(dof)]);
    }
  };
  for (const std::size_t e : front.elements) {
    const Eigen::Ref<const Eigen::MatrixXd> local = matrix_of(e);
    look_up(dofs_[e]);
    for (std::size_t j = 0; j < places.size(); ++j) {
      sum.add_column(places, j, local.col(static_cast<Eigen::Index>(j)).data());
    }
  }
  for (auto child = front.children.rbegin(); child != front.children.rend(); ++child) {
    if (*child < 0) continue;
    look_up(fronts_[static_cast<std::size_t>(*child)].waiting_dofs());
    children -= places.size() * places.size();
    sum.add_child(places, children);
  }
}

bool MultifrontalLdlt::factor(const MatrixOf& matrix_of, const std::function<void()>& keep_going) {
  stack_.resize(stack_size_);
  double* top = stack_.data();
  DenseProduct product;
  Eigen::MatrixXd scaled;
  for (Front& front : fronts_) {
    const auto size = static_cast<Eigen::Index>(front.dofs.size());
    const Eigen::Index count = size - front.eliminated;
    Eigen::Map<Eigen::MatrixXd> waiting(top, count, count);  // moved to where its children were
    front.columns.resize(size, front.eliminated);
    assemble(matrix_of, front, top, {front.columns, waiting});
    scaled.resize(size, front.eliminated);
    if (!eliminate(front.columns, scaled, product, keep_going)) return false;
    for (Eigen::Index begin = 0; begin < front.eliminated; begin += kDepth) {
      keep_going();
      const Eigen::Index depth = std::min(kDepth, front.eliminated - begin);
      product.subtract_lower(front.columns.block(front.eliminated, begin, count, depth),
                             scaled.block(front.eliminated, begin, count, depth), waiting);
    }
    front.pivots = front.columns.diagonal();
    for (const int child : front.children) {
      if (child < 0) continue;
      const std::size_t left = fronts_[static_cast<std::size_t>(child)].waiting_dofs().size();
      top -= left * left;
    }
    for (Eigen::Index j = 0; j < count; ++j) {  // of the lower triangle, forwards
      std::copy_n(waiting.data() + j * (count + 1), count - j, top + j * (count + 1));
    }
    top += waiting.size();
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
