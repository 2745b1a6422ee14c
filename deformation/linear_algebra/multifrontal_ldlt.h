// Direct solver for matrices that are sums of small element matrices: nested dissection of the
// elements, and an L D Lᵀ factorisation front by front.
//   A. George, "Nested dissection of a regular finite element mesh", SIAM J. Numer. Anal. 10, 1973
//   I. Duff, J. Reid, "The multifrontal solution of indefinite sparse symmetric linear systems",
//   ACM Trans. Math. Softw. 9, 1983
//
// The elements are halved again and again. An unknown of one half only is eliminated inside it; one
// of both halves waits. Each half is a dense front, of which the part that waits goes up to the
// next.
//
// Without pivoting: fit for symmetric quasi-definite matrices [K B; Bᵀ −C] with K, C positive
// definite, which have an L D Lᵀ in every order (R. Vanderbei, SIAM J. Optim. 5, 1995). Unknowns of
// higher index are eliminated later within a front: pressures after displacements.
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <span>
#include <vector>

#include "modules/core/types.h"

namespace palpate::deformation {

class MultifrontalLdlt {
 public:
  /// The matrix of an element, in the order of its unknowns; its lower triangle is looked at. Used
  /// before the next one is asked for.
  using MatrixOf = std::function<Eigen::Ref<const Eigen::MatrixXd>(std::size_t element)>;

  /// @param dofs     unknowns of each element, -1: left out (constrained)
  /// @param centres  of the elements [m], what the halving goes by
  MultifrontalLdlt(std::size_t dof_count, std::vector<std::vector<int>> dofs,
                   std::vector<Vec3> centres);

  /// @param keep_going  asked several times a second; may throw, and then as for false:
  /// @returns false if a pivot was zero or not finite: then solve() may not be called
  bool factor(
      const MatrixOf& matrix_of, const std::function<void()>& keep_going = [] {});

  /// Solves in place for every column; unknowns left out come out as zero.
  /// @param b  (dof_count × any)
  void solve(Eigen::Ref<Eigen::MatrixXd> b) const;

  /// By Sylvester's law the matrix's negative eigenvalues.
  std::size_t negative_pivots() const;

 private:
  struct Front {
    std::vector<int> dofs;  ///< those eliminated here, then those that wait, each ascending
    Eigen::Index eliminated = 0;
    std::vector<std::size_t> elements;  ///< of a front without children
    std::array<int, 2> children{-1, -1};
    Eigen::MatrixXd columns;  ///< L, unit diagonal not stored  (dofs × eliminated)
    Eigen::VectorXd pivots;   ///< D

    /// What goes up to the parent, as a lower triangle on the stack.
    std::span<const int> waiting_dofs() const {
      return std::span(dofs).subspan(static_cast<std::size_t>(eliminated));
    }
  };
  /// A front being assembled, lower triangles: the columns to eliminate, and the rest.
  struct Sum {
    Eigen::Ref<Eigen::MatrixXd> own, waiting;
    void add_column(std::span<const Eigen::Index> places, std::size_t begin, const double* values);
    void add_child(std::span<const Eigen::Index> places, const double* values);
  };
  struct DofUse {
    int dof = 0, elements = 0;
  };

  std::vector<DofUse> build(std::span<std::size_t> elements);
  std::size_t split(std::span<std::size_t> elements);
  void add_front(std::vector<DofUse>& uses, Front front);
  void assemble(const MatrixOf& matrix_of, const Front& front, const double* children, Sum sum);

  std::size_t dof_count_ = 0;
  std::vector<std::vector<int>> dofs_;
  std::vector<Vec3> centres_;
  std::vector<int> use_counts_;       ///< elements of each unknown
  std::vector<int> marks_;            ///< scratch: last front that looked at an unknown
  std::vector<Eigen::Index> places_;  ///< scratch: an unknown's row in the front at hand
  int mark_ = 0;
  std::vector<Front> fronts_;  ///< children before parents
  std::size_t stack_size_ = 0, stacked_ = 0;
  std::vector<double> stack_;  ///< scratch: what fronts without a parent yet left for it
};

}  // namespace palpate::deformation
