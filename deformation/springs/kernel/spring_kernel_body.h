// The spring kernel for any instruction set: included once by each spring_kernel_<set>.cpp, which
// is compiled for that set and gives `Floats` for the springs and `Doubles` for the volume
// (deformation/packs/vector3.h).
//
// A slice is worked through in kLanes / kWidth parts. Every lane does the same operations in the
// same order whatever the width, and sums over lanes are taken in lane order, so all sets that fuse
// multiply and add give the same bits.
#pragma once

#include "deformation/packs/vector3.h"
#include "deformation/springs/kernel/spring_kernel_coordinates.h"
#include "deformation/springs/kernel/spring_kernel_springs.h"

namespace palpate::deformation::kernel {
namespace {

/// The volume itself, in double, and what joins both.
template <class Floats, class Doubles>
struct Kernel {
  using Nodes = Vector3<Doubles>;

  /// Σ d_j × d_j+1 of kWidth fans, two at a time: d_1 × d_2 + d_2 × d_3 = d_2 × (x_3 − x_1).
  static Nodes fan_sum(const Step& step, const FanTable& table, std::size_t index, std::size_t lane,
                       const Nodes& center) {
    const Fans& fans = table.fans[index];
    const std::uint32_t* const nodes = table.nodes + fans.first_slot * kDoubleLanes + lane;
    const auto load = [&](std::size_t slot) {
      return Doubles::load_nodes(step.positions, nodes + slot * kDoubleLanes);
    };
    Nodes sum = no_vectors<Doubles>(), before = load(1);
    for (std::size_t slot = 2; slot < fans.slots; slot += 2) {
      const Nodes d = load(slot) - center, after = load(slot + 1);
      add_cross(sum, d, after - before);
      before = after;
    }
    return sum;
  }

  static Nodes centers(const Step& step, const FanTable& table, std::size_t index,
                       std::size_t lane) {
    const std::size_t first = table.fans[index].first_slot * kDoubleLanes + lane;
    return Doubles::load_nodes(step.positions, table.nodes + first);
  }

  /// A chunk's share of V: a fan and the origin enclose (x − origin)·Σ d_j × d_j+1 / 6.
  static double chunk_volume(const Layout& layout, const Step& step, std::size_t chunk) {
    const Nodes origin{Doubles::broadcast(step.origin[0]), Doubles::broadcast(step.origin[1]),
                       Doubles::broadcast(step.origin[2])};
    double sixfold[kDoubleLanes], total = 0;
    for (std::size_t lane = 0; lane < kDoubleLanes; lane += Doubles::kWidth) {
      typename Doubles::Pack sum = Doubles::broadcast(0);
      for (std::uint32_t k = layout.first_fans[chunk]; k < layout.first_fans[chunk + 1]; ++k) {
        const Nodes center = centers(step, layout.cover, k, lane);
        sum = sum + dot(center - origin, fan_sum(step, layout.cover, k, lane, center));
      }
      Doubles::store(sixfold + lane, sum);
    }
    for (const double part : sixfold) total += part;
    return total / 6;
  }

  /// Rows from `first` on as far as there are nodes.
  static void store_rows(const Layout& layout, std::size_t first, double* base,
                         const Nodes& nodes) {
    constexpr std::size_t kWidth = Doubles::kWidth;
    if (first + kWidth <= layout.surface_node_count) {
      Doubles::store_nodes(base + 3 * first, nodes);
      return;
    }
    double all[3 * kWidth];
    Doubles::store_nodes(all, nodes);
    for (std::size_t i = 3 * first; i < 3 * layout.surface_node_count; ++i) {
      base[i] = all[i - 3 * first];
    }
  }

  /// A slice's floats to `base`, three doubles a row.
  static void store_slice(const Layout& layout, std::size_t index, const Rows& rows, double* base) {
    for (std::size_t lane = 0; lane < kLanes; lane += Doubles::kWidth) {
      store_rows(layout, index * kLanes + lane, base,
                 {Doubles::widen(rows.x + lane), Doubles::widen(rows.y + lane),
                  Doubles::widen(rows.z + lane)});
    }
  }

  /// 6 g of a slice, in double, to where g will be.
  static void ring_slice(const Layout& layout, const Step& step, std::size_t index) {
    for (std::size_t lane = 0; lane < kLanes; lane += Doubles::kWidth) {
      const std::size_t first = index * kLanes + lane, rings = first / kDoubleLanes;
      const Nodes center = centers(step, layout.rings, rings, first % kDoubleLanes);
      store_rows(layout, first, step.gradient,
                 fan_sum(step, layout.rings, rings, first % kDoubleLanes, center));
    }
  }

  /// Where a chunk's coordinates end.
  static std::size_t end_of(const Layout& layout, const SliceRange& slices) {
    return 3 * (slices.end < layout.slice_count ? kLanes * slices.end : layout.surface_node_count);
  }

  /// Forces and 6 g of the chunk's slices, to where v̂ and g will be.
  template <bool kVolume>
  static void step_chunk(const Layout& layout, const Step& step, std::size_t chunk) {
    const std::size_t stride = 3 * kLanes * layout.virtual_node_count;
    float* const virtual_forces = step.virtual_forces + stride * chunk;
    for (std::size_t i = 0; i < stride; ++i) virtual_forces[i] = 0;
    const SliceRange slices = slices_of(layout, chunk);
    for (std::size_t index = slices.begin; index < slices.end; ++index) {
      Rows forces, rings;
      Springs<Floats>::template add_slice<kVolume>(layout, step, index, virtual_forces, forces,
                                                   rings);
      store_slice(layout, index, forces, step.new_velocities);
      if constexpr (kVolume) store_slice(layout, index, rings, step.gradient);
    }
    step.sums[chunk] =
        finish_slices<kVolume>(layout, step, 3 * kLanes * slices.begin, end_of(layout, slices));
    if constexpr (kVolume) step.sums[chunk].volume = chunk_volume(layout, step, chunk);
  }

  static void volume_chunk(const Layout& layout, const Step& step, std::size_t chunk) {
    const SliceRange slices = slices_of(layout, chunk);
    for (std::size_t index = slices.begin; index < slices.end; ++index) {
      ring_slice(layout, step, index);
    }
    step.sums[chunk] =
        finish_volume(layout, step, 3 * kLanes * slices.begin, end_of(layout, slices));
  }

  static void pack(const Packing& packing, std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      Floats::pack_node(packing.positions + 3 * i, packing.origin, packing.nodes + kNodeFloats * i);
      float* const second = packing.nodes + kNodeFloats * i + 4;
      if (packing.velocities != nullptr) {
        constexpr double kNone[4] = {};
        Floats::pack_node(packing.velocities + 3 * i, kNone, second);
      } else {
        for (int axis = 0; axis < 4; ++axis) second[axis] = 0;
      }
    }
  }

  static constexpr Functions functions{&pack,
                                       &step_chunk<true>,
                                       &step_chunk<false>,
                                       &volume_chunk,
                                       &move,
                                       &Springs<Floats>::chunk_energy};
};

}  // namespace
}  // namespace palpate::deformation::kernel
