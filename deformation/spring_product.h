// The matrix of an implicit step times a vector, fast: spring_linearization.h says what it is, and
// is the plain code this agrees with to the rounding of floats.
//
// Each node gathers from its neighbours, eight nodes side by side in the slices of the spring
// kernel (spring_kernel_arrays.h). Any number of threads gives the same bits.
#pragma once

#include <vector>

#include "deformation/organ_model.h"
#include "deformation/spring_kernel.h"
#include "deformation/spring_product_arrays.h"
#include "deformation/wide_vectors.h"
#include "modules/core/parallel.h"

namespace palpate::deformation {

class SpringProduct {
 public:
  /// @param model   outlives this
  /// @param runner  outlives this; none: the calling thread alone
  /// @param set     kAvx512 stands for kAvx2, there is none of its own
  explicit SpringProduct(const OrganModel& model, ChunkRunner* runner = nullptr,
                         InstructionSet set = available_instruction_sets().back());

  /// Takes A at these positions [m] (node_count) for a step of h [s].
  void linearise(const std::vector<Vec3>& positions, double h);

  const std::vector<Mat3>& diagonal() const { return diagonal_; }  ///< D [kg]  (node_count)

  /// out = A p. Rows of fixed nodes are like any other: leave p zero there and ignore them.
  /// @param p    [m/s]  (node_count)
  /// @param out  [N·s]  (node_count)
  void apply(const std::vector<Vec4f>& p, std::vector<Vec4f>& out);

 private:
  void add_rows(const kernel::Layout& layout);
  kernel::ProductLayout view() const;
  kernel::Couplings couplings();
  void run(ChunkBody body);
  void take_diagonal(double h);

  const OrganModel& model_;
  ChunkRunner* runner_;
  const kernel::ProductFunctions& functions_;
  SpringKernelLayout layout_;
  kernel::ProductLayout scalars_;
  std::vector<std::uint32_t> neighbours_, row_nodes_, inner_nodes_;
  std::vector<kernel::ProductLink> links_;
  std::vector<float> rest_lengths_, ring_sizes_;
  std::vector<float> inner_rest_lengths_, inner_stiffnesses_, inner_dampings_;
  float h_ = 0;
  std::vector<Vec4f> positions_;  ///< from the first node, so that float has digits enough
  std::vector<float> masses_;     ///< (1 + h·drag) M; of rows, then of virtual nodes
  std::vector<float> along_, across_, inner_along_, inner_across_;
  std::vector<float> blocks_;          ///< of the rows, by slice
  std::vector<float> virtual_blocks_;  ///< by chunk and virtual node
  std::vector<float> virtual_sums_;    ///< likewise
  std::vector<Mat3> diagonal_;
};

}  // namespace palpate::deformation
