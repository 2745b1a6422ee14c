// Builds the arrays of spring_kernel_arrays.h from a body and its springs.
#pragma once

#include <span>
#include <vector>

#include "deformation/model/body.h"
#include "deformation/model/spring_network.h"
#include "deformation/springs/kernel/spring_kernel_arrays.h"
#include "modules/core/aligned_vector.h"
#include "modules/geometry/triangle_fans.h"

namespace palpate::deformation {

class SpringKernelLayout {
 public:
  /// @param with_volume  whether the triangles around each node are wanted, too
  SpringKernelLayout(const Body& body, const SpringNetwork& network, bool with_volume);

  /// Valid as long as this lives and stays where it is.
  kernel::Layout view() const;

 private:
  struct Neighbour {
    std::uint32_t node = 0;
    double rest_length = 0;
  };
  using Rows = std::vector<std::vector<Neighbour>>;
  struct FanArrays {
    std::vector<kernel::Fans> fans;
    AlignedVector<std::uint32_t> nodes;

    /// These side by side. @param some  1 … kernel::kDoubleLanes
    void add(std::span<const geometry::Fan> some);
    kernel::FanTable view() const { return {fans.data(), nodes.data()}; }
  };

  /// Neighbours by springs [first, first + count), seen from both ends.
  static Rows rows_of(const Body& body, const SpringNetwork& network, std::size_t first,
                      std::size_t count);
  /// Each row's neighbours in the order of its ring.
  static void put_in_order(const std::vector<std::vector<std::uint32_t>>& rings, Rows& rows);
  void add_rows(const Body& body);
  void add_slice(std::size_t first_row, const Rows& structural, const Rows& bending);
  void add_rings(const std::vector<std::vector<std::uint32_t>>& rings);
  void add_cover(const std::vector<std::vector<std::uint32_t>>& rings);
  void add_inner_springs(const SpringNetwork& network);
  void add_links(std::size_t slice);

  kernel::Layout scalars_;
  std::vector<kernel::Slice> slices_;
  std::vector<kernel::Link> links_;
  FanArrays rings_, cover_;
  std::vector<std::uint32_t> first_fans_;
  AlignedVector<std::uint32_t> neighbours_, row_nodes_, inner_nodes_;
  AlignedVector<float> rest_lengths_;
  AlignedVector<double> inverse_masses_;
  AlignedVector<float> inner_rest_lengths_, inner_stiffnesses_, inner_dampings_;
};

}  // namespace palpate::deformation
