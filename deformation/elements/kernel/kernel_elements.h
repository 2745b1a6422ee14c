// Linear tetrahedra as an implicit step needs them, fast: what is common to both kinds. The plain
// code is average_nodal_pressure.h and corotational.h, the oracle of the tests.
//
// Geometry, volumes and forces are double; the matrix is float, as it is there. Any number of
// threads gives the same bits, and so do AVX2 and AVX-512; the portable code, for CPUs that do not
// fuse multiply and add, differs in the last digits. Allocates at construction only.
#pragma once

#include <span>
#include <vector>

#include "deformation/elements/elastic_force_elements.h"
#include "deformation/elements/kernel/element_parts.h"
#include "deformation/packs/instruction_set.h"
#include "modules/core/parallel.h"

namespace palpate::deformation {

class KernelElements : public ElasticForceElements {
 public:
  const std::vector<Vec3>& forces() const override { return forces_; }
  const std::vector<Mat3>& diagonal() const override { return diagonal_; }
  void apply(const std::vector<Vec4f>& p, std::vector<Vec4f>& out) override;
  void add_block(const Patch& patch, float share, Eigen::MatrixXf& sum) const override;

 protected:
  /// @param with_volumes  whether A has Σ_a w_a (∂v_a)(∂v_a)ᵀ of the nodes' volumes, 4 v_a kept
  /// @param runner        outlives this; none: the calling thread alone
  KernelElements(LinearTetrahedra tetrahedra, bool with_volumes, ChunkRunner* runner,
                 InstructionSet set);

  const LinearTetrahedra& mesh() const { return mesh_; }
  const ElementParts& parts() const { return parts_; }
  const kernel::ElementFunctions& functions() const { return functions_; }
  const kernel::ElementArrays& arrays() const { return arrays_; }
  /// w_a of a slot's node.
  void set_weight(std::size_t slot, float weight) { slot_weights_[slot] = weight; }

  /// Calls body(part) for all parts.
  template <class Body>
  void for_parts(const Body& body) {
    run([&](std::size_t index) { body(parts_.parts()[index]); });
  }
  void load_positions(const kernel::ElementPart& part, const std::vector<Vec3>& positions);
  /// Adds up what body(part) returns.
  template <class Body>
  double sum_over_parts(const Body& body) {
    run([&](std::size_t index) { part_sums_[index] = body(parts_.parts()[index]); });
    return total_of_parts();
  }
  /// Σ over a node's slots.
  double sum_of(const double* numbers, std::size_t node) const;

  /// After assembly: what parts share is added up, shift to the diagonal.
  void finish(std::span<const double> shift);

 private:
  void run(ChunkBody body);
  double total_of_parts() const;
  void merge(const kernel::ElementPart& part, std::span<const double> shift);
  void collect(const kernel::ElementPart& part);
  Vec4f column_gradient(std::size_t pair) const;
  /// Calls body(row's slot, column's slot, pair) for all pairs.
  template <class Body>
  void for_pairs(const Body& body) const {
    for (const kernel::ElementPart& part : parts_.parts()) {
      const std::uint32_t nobody = part.first_slot + part.slot_count;
      for (std::uint32_t g = 0; g < part.group_count; ++g) {
        for (std::uint32_t k = 0; k < kernel::kGroupPairs; ++k) {
          const std::uint32_t at = kernel::kGroupPairs * g + k, column = part.columns[at] / 4;
          if (column == nobody) continue;
          body(part.rows[g] / 4, column, kernel::kGroupPairs * part.first_group + at);
        }
      }
    }
  }
  /// A pair and where its nodes stand in a patch; −1: not among them.
  struct Touching {
    std::uint32_t row = 0, column = 0, pair = 0;
    int row_place = 0, column_place = 0;
  };
  void add_pair(std::size_t pair, float share, int a, int b, Eigen::MatrixXf& sum) const;
  void add_volume_block(const Patch& patch, std::span<const Touching> touching, float share,
                        Eigen::MatrixXf& sum) const;

  LinearTetrahedra mesh_;
  bool with_volumes_;
  ChunkRunner* runner_;
  const kernel::ElementFunctions& functions_;
  ElementParts parts_;
  AlignedVector<double> positions_, part_forces_, node_volumes_, volumes_;
  AlignedVector<float> blocks_, volume_gradients_, own_diagonals_, part_diagonals_, open_, p_,
      product_, rates_, weighted_rates_, slot_weights_;
  AlignedVector<float> whole_diagonals_;  ///< with the volumes' part; to be summed  (slot × 12)
  kernel::ElementArrays arrays_;
  std::vector<double> part_sums_;
  std::vector<Vec3> forces_;
  std::vector<Mat3> diagonal_;
};

}  // namespace palpate::deformation
