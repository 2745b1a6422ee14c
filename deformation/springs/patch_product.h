// The spring product among the nodes of a patch, all others held.
#pragma once

#include <vector>

#include "deformation/model/patch.h"
#include "deformation/springs/spring_hessian_product.h"

namespace palpate::deformation {

class PatchProduct {
 public:
  /// @param springs  outlives this
  explicit PatchProduct(SpringHessianProduct& springs) : springs_(springs) {}

  /// Of surface nodes; the springs' own vectors become zero.
  /// @param patch   stays as it is until the next one
  /// @param slices  theirs
  void take(const Patch& patch, std::span<const std::uint32_t> slices);

  /// Their vectors p are for the caller to set. Last a node that is held, which stands for any
  /// other.  (patch + 1)
  AlignedVector<WideNode>& nodes() { return nodes_; }

  /// out = A p of the patch.  (patch, at least)
  /// @returns p·A p
  double apply(std::vector<Vec4f>& out);

 private:
  SpringHessianProduct& springs_;
  std::span<const std::uint32_t> patch_, slices_;
  AlignedVector<WideNode> nodes_;
  std::vector<Vec4f> products_;  ///< (node_count)
};

}  // namespace palpate::deformation
