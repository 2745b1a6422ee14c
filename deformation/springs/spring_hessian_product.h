// The matrix of an implicit step times a vector, fast: projected_spring_stiffness.h says what it
// is, and is the plain code this agrees with to eight binary digits of a spring's two numbers, as
// they are kept here (spring_hessian_product_arrays.h). The matrix stays symmetric and positive.
//
// Each node gathers from its neighbours, sixteen nodes side by side in the slices of the spring
// kernel (spring_kernel_arrays.h). Any number of threads gives the same bits. What is local is
// found from the slices of a patch's nodes alone.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "deformation/springs/kernel/spring_hessian_product_arrays.h"
#include "deformation/springs/kernel/spring_kernel.h"
#include "modules/core/aligned_vector.h"
#include "modules/core/parallel.h"
#include "modules/core/simd_vectors.h"

namespace palpate::deformation {

/// A matrix: mass M + damping D + stiffness K.
struct SpringShares {
  double mass = 0, damping = 0, stiffness = 0;
};

/// What a contact adds to such a matrix: a aᵀ, a of three nodes.
struct ContactCoupling {
  std::array<std::uint32_t, 3> nodes{};
  std::array<Vec4f, 3> arms{Vec4f::Zero(), Vec4f::Zero(), Vec4f::Zero()};  ///< [√kg]
};

/// out += a (a·p) for each.
/// @param nodes  with the vectors p
/// @returns Σ (a·p)²
double add_couplings(std::span<const ContactCoupling> couplings,
                     const AlignedVector<WideNode>& nodes, std::vector<Vec4f>& out);

/// The matrix as the kernel sees it, while the product lives and until it is taken anew.
struct SpringMatrix {
  const kernel::ProductFunctions& functions;
  kernel::Layout layout;
  kernel::Couplings springs;
  const float* masses = nullptr;  ///< of rows
  std::span<const ContactCoupling> contacts;
};

class SpringHessianProduct {
 public:
  /// @param body         outlives this
  /// @param with_volume  as of the kernel beside it: neighbours then stand in the same order
  /// @param runner  outlives this; none: the calling thread alone
  SpringHessianProduct(const Body& body, const SpringNetwork& network, bool with_volume,
                       ChunkRunner* runner = nullptr,
                       InstructionSet set = available_instruction_sets().back());

  /// Takes A at these positions [m] (node_count) for a step of h [s].
  void linearise(const std::vector<Vec3>& positions, double h);
  /// The same in some slices, of any shares of M, D and K with some K among them.
  void linearise(const std::vector<Vec3>& positions, const SpringShares& shares,
                 std::span<const std::uint32_t> slices);

  /// Adds couplings to A, not to its diagonal, instead of those before; linearise() drops them.
  void couple(std::span<const ContactCoupling> couplings);

  /// Slices that hold these surface nodes, rising.
  void find_slices(std::span<const std::uint32_t> nodes, std::vector<std::uint32_t>& slices) const;

  const std::vector<Mat3>& diagonal() const { return diagonal_; }  ///< D [kg]  (node_count)

  /// Nodes as the product loads them; their vectors p [m/s] are for the caller to set. (node_count)
  AlignedVector<WideNode>& nodes() { return nodes_; }

  SpringMatrix matrix();

  /// out = A p. Rows of fixed nodes are like any other: leave p zero there and ignore them.
  /// @param out  [N·s]  (node_count)
  /// @returns p·A p
  double apply(std::vector<Vec4f>& out);
  /// The same of the surface nodes in some slices.
  double apply(std::span<const std::uint32_t> slices, std::vector<Vec4f>& out);

 private:
  kernel::Couplings couplings();
  /// Of slices of a patch: enough that another thread is worth its waking.
  static constexpr std::size_t kSlicesInPart = 16;

  void run(std::size_t count, ChunkBody body);
  std::size_t part_count(std::span<const std::uint32_t> slices) const;
  kernel::SliceList part_of(std::span<const std::uint32_t> slices, std::size_t part) const;
  kernel::SliceList slices_of(std::size_t chunk) const;
  void take_positions(const std::vector<Vec3>& positions);
  void take_row_diagonal(std::size_t node, double mass_share);
  void take_row_diagonals(const kernel::SliceList& list, double mass_share);
  void take_virtual_diagonal(double h);

  const Body& body_;
  ChunkRunner* runner_;
  const kernel::ProductFunctions& functions_;
  SpringKernelLayout layout_;
  float h_ = 0, damping_ = 1;
  std::vector<std::uint32_t> all_slices_;
  AlignedVector<WideNode> nodes_;  ///< positions from the first node
  AlignedVector<float> masses_;    ///< (1 + h·drag) M; of rows, then of virtual nodes
  AlignedVector<float> pairs_, inner_along_, inner_across_;
  AlignedVector<float> blocks_;          ///< of the rows, by slice
  AlignedVector<float> virtual_blocks_;  ///< by chunk and virtual node
  AlignedVector<float> virtual_sums_;    ///< likewise
  AlignedVector<float> dots_;            ///< of p and A p, by chunk and lane
  std::vector<Mat3> diagonal_;
  std::vector<ContactCoupling> contacts_;
};

}  // namespace palpate::deformation
