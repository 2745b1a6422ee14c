// C ← C − A Bᵀ for dense blocks, what nearly all work of a factorisation is.
//   K. Goto, R. van de Geijn, "Anatomy of high-performance matrix multiplication", ACM Trans. Math.
//   Softw. 34, 2008
//
// Strips of A and B are copied so that a tile of C, which stays in registers, reads them in order.
// Compiled for several instruction sets; the CPU at hand decides which one runs. Those with fused
// multiply-add give the same bits as each other, for each entry of C is one sum in one order.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "deformation/packs/instruction_set.h"

namespace palpate::deformation {

class DenseProduct {
 public:
  using Block = Eigen::Ref<Eigen::MatrixXd, 0, Eigen::OuterStride<>>;
  using ConstBlock = Eigen::Ref<const Eigen::MatrixXd, 0, Eigen::OuterStride<>>;

  /// By the fastest instruction set of this CPU.
  DenseProduct();
  /// @param set  one that this CPU has
  explicit DenseProduct(InstructionSet set);

  /// C −= A Bᵀ
  void subtract(const ConstBlock& a, const ConstBlock& b, Block c);
  /// The same where row ≥ column; entries just above the diagonal may change, too.
  void subtract_lower(const ConstBlock& a, const ConstBlock& b, Block c);

 private:
  InstructionSet set_;
  std::vector<double> strips_;  ///< scratch: copies of a and b
};

}  // namespace palpate::deformation
