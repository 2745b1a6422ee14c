// The spring product among the nodes of a patch, all others held: the same sums in the same order
// (spring_hessian_product.h), of arrays that hold the patch's rows alone, side by side. A patch's
// nodes lie scattered over three times as many slices as they fill.
#pragma once

#include <vector>

#include "deformation/model/patch.h"
#include "deformation/springs/spring_hessian_product.h"

namespace palpate::deformation {

class PatchProduct {
 public:
  /// @param springs  outlives this
  /// @param runner   outlives this; none: the calling thread alone. The bits are the same
  explicit PatchProduct(SpringHessianProduct& springs, ChunkRunner* runner = nullptr)
      : springs_(springs), runner_(runner) {}

  /// Takes the patch's surface nodes, if any, and A as the springs have it now, without couplings
  /// of contacts.
  void take(const Patch& patch);

  /// Adds the springs' couplings to A, instead of those before.
  void take_couplings(const Patch& patch);

  /// Their vectors p are for the caller to set. After them a node that is held, which stands for
  /// any other, and what is held about them.  (patch + 1, at least)
  AlignedVector<WideNode>& nodes() { return nodes_; }

  /// out = A p of the patch.  (patch, at least)
  /// @returns p·A p
  double apply(std::vector<Vec4f>& out);

 private:
  /// Of a patch: enough that another thread is worth its waking.
  static constexpr std::size_t kSlicesInPart = 32;

  std::size_t parts() const { return (slices_.size() + kSlicesInPart - 1) / kSlicesInPart; }
  /// A held one gets a place when it is first asked for.
  std::uint32_t place_of(const Patch& patch, std::uint32_t node);
  void take_slice(const Patch& patch, std::size_t first_row);
  void take_inner_springs(const Patch& patch);

  SpringHessianProduct& springs_;
  ChunkRunner* runner_;
  std::size_t count_ = 0;  ///< nodes of the patch
  AlignedVector<WideNode> nodes_;
  std::vector<std::int32_t> held_places_;  ///< in nodes_, −1: none  (node_count)
  std::vector<std::uint32_t> held_;        ///< nodes that have one
  kernel::Layout layout_;
  std::vector<kernel::Slice> slices_;
  std::vector<std::uint32_t> all_slices_;
  AlignedVector<std::uint32_t> row_nodes_, neighbours_, inner_nodes_;
  AlignedVector<float> pairs_, masses_, inner_along_, inner_across_, virtual_sums_, dots_;
  std::vector<ContactCoupling> contacts_;
};

}  // namespace palpate::deformation
