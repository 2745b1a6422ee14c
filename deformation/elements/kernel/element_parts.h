// A mesh of tetrahedra cut into parts for the element kernel (element_kernel_arrays.h says how it
// is kept). Which tetrahedra make a part depends on the mesh alone.
//
// Cut in halves across the longest side, again and again (M. Berger, S. Bokhari, IEEE Trans.
// Comput. 36, 1987), until a part is small; the same halving, carried on, is the order within a
// part, so that neighbours in space are near in memory.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "deformation/elements/kernel/element_kernel_arrays.h"
#include "deformation/elements/linear_tetrahedra.h"
#include "modules/core/aligned_vector.h"

namespace palpate::deformation {

class ElementParts {
 public:
  /// Tetrahedra of a part, at most: what a part's product reads then stays in a core's own cache.
  static constexpr std::size_t kMostTetrahedra = 3000;

  explicit ElementParts(const LinearTetrahedra& mesh);
  ElementParts(const ElementParts&) = delete;
  ElementParts& operator=(const ElementParts&) = delete;

  std::span<const kernel::ElementPart> parts() const { return parts_; }
  kernel::Tetrahedra tetrahedra() const {
    return {corners_.data(), pairs_.data(), flips_.data(), gradients_.data(), rest_volumes_.data()};
  }
  std::size_t slot_count() const { return nodes_.size(); }  ///< of all parts, empty nodes too
  std::size_t group_count() const { return group_count_; }  ///< spilt ones, too
  std::size_t batch_count() const { return rest_volumes_.size() / kernel::kTetrahedronLanes; }
  std::size_t open_count() const { return open_pairs_.size(); }

  static constexpr std::uint32_t kNoNode = ~0u;
  /// Of a slot; kNoNode of an empty one.
  std::uint32_t node(std::size_t slot) const { return nodes_[slot]; }
  /// Of a node, in the order of the parts; the first is the one that owns it.
  std::span<const std::uint32_t> slots(std::size_t node) const {
    return std::span(slots_).subspan(first_slots_[node],
                                     first_slots_[node + 1] - first_slots_[node]);
  }

 private:
  friend class ElementPartsBuilder;

  std::vector<kernel::ElementPart> parts_;
  std::size_t group_count_ = 0;
  std::vector<std::uint32_t> nodes_;                ///< of slots
  std::vector<std::uint32_t> first_slots_, slots_;  ///< of nodes
  std::vector<std::uint32_t> rows_, columns_, owned_, open_slots_;
  std::vector<kernel::SharedSlot> shared_;
  std::vector<kernel::OpenPair> open_pairs_;
  std::vector<kernel::Merge> pair_merges_, node_merges_;
  std::vector<std::uint32_t> corners_, pairs_;
  AlignedVector<float> flips_;
  AlignedVector<double> gradients_, rest_volumes_;
};

}  // namespace palpate::deformation
