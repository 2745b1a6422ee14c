// The spring product for any instruction set: included once by each spring_product_<set>.cpp. `Set`
// is as in spring_kernel_body.h with floats, kWidth of them, and further
//
//   load_nodes(base, indices)       x, y, z of kWidth nodes of four floats each
//   store_nodes(base, nodes)        of kWidth consecutive nodes, their fourth float 0
//   root(Pack), absolute(Pack)      elementwise
#pragma once

#include "deformation/spring_kernel_vector3.h"
#include "deformation/spring_product_arrays.h"

namespace palpate::deformation::kernel {
namespace {

/// Springs shorter than its root have no direction [m²].
constexpr float kShortestSquare = 1e-20f;

template <class Set>
struct Product {
  using Pack = typename Set::Pack;
  using Nodes = Vector3<Set>;
  static constexpr std::size_t kWidth = Set::kWidth;

  static Nodes zero() {
    const Pack none = Set::broadcast(0);
    return {none, none, none};
  }

  /// Part of a diagonal block, in the order of kBlockNumbers.
  struct Block {
    Pack numbers[kBlockNumbers];

    Block() {
      for (Pack& number : numbers) number = Set::broadcast(0);
    }
    void add(const Nodes& d, const Pack& along, const Pack& across) {
      const Nodes scaled{along * d.x, along * d.y, along * d.z};
      numbers[0] = Set::fma(scaled.x, d.x, numbers[0]);
      numbers[1] = Set::fma(scaled.x, d.y, numbers[1]);
      numbers[2] = Set::fma(scaled.x, d.z, numbers[2]);
      numbers[3] = Set::fma(scaled.y, d.y, numbers[3]);
      numbers[4] = Set::fma(scaled.y, d.z, numbers[4]);
      numbers[5] = Set::fma(scaled.z, d.z, numbers[5]);
      numbers[6] = numbers[6] + across;
    }
    void store(float* to) const {
      for (std::size_t n = 0; n < kBlockNumbers; ++n) Set::store(to + n * kLanes, numbers[n]);
    }
    void add_weighted_to(float* to, const Pack& weight) const {
      for (std::size_t n = 0; n < kBlockNumbers; ++n, to += kLanes) {
        Set::store(to, Set::fma(weight, numbers[n], Set::load(to)));
      }
    }
  };

  struct Coupling {
    Pack along, across;
  };

  /// h J of springs along d: h k (1 − l₀/l)₊ across, (h c + h² k − across)/l² along.
  static Coupling coupling_of(const Nodes& d, const Pack& rest_length, const Pack& stiffness,
                              const Pack& damping, float h) {
    const Pack one = Set::broadcast(1), step = Set::broadcast(h);
    const Pack square = dot(d, d);
    const Pack shortest = Set::broadcast(kShortestSquare);
    const Pack inverse_square = Set::keep_below(one / square, shortest, square);
    const Pack stretch = Set::fnma(rest_length, Set::root(inverse_square), one);
    const Pack h_k = step * stiffness;
    const Pack pulled = stretch + Set::absolute(stretch);
    const Pack across =
        Set::keep_below(Set::broadcast(0.5f) * step * h_k * pulled, shortest, square);
    return {(step * (damping + h_k) - across) * inverse_square, across};
  }

  static void linearise_part(const ProductLayout& layout, const Couplings& couplings,
                             std::size_t index, std::size_t lane, float* blocks,
                             float* virtual_blocks) {
    const Slice& slice = layout.slices[index];
    const std::size_t first = index * kLanes + lane;
    const Nodes x = Set::load_nodes(couplings.positions, layout.row_nodes + first);
    Block block;
    const auto add = [&](std::size_t k, float stiffness, float damping, bool ring) {
      const std::size_t slot = (slice.first_slot + k) * kLanes + lane;
      const Nodes d = Set::load_nodes(couplings.positions, layout.neighbours + slot) - x;
      Coupling c = coupling_of(d, Set::load(layout.rest_lengths + slot), Set::broadcast(stiffness),
                               Set::broadcast(damping), couplings.h);
      if (ring) {
        const Pack number = Set::broadcast(static_cast<float>(k));
        const Pack size = Set::load(layout.ring_sizes + first);
        c = {Set::keep_below(c.along, number, size), Set::keep_below(c.across, number, size)};
      }
      Set::store(couplings.along + slot, c.along);
      Set::store(couplings.across + slot, c.across);
      block.add(d, c.along, c.across);
    };
    for (std::size_t k = 0; k < slice.ring_slots; ++k) {
      add(k, layout.structural_stiffness, layout.structural_damping, true);
    }
    for (std::size_t k = slice.ring_slots; k < slice.slots; ++k) {
      add(k, layout.bending_stiffness, layout.bending_damping, false);
    }
    if (layout.virtual_node_count > 0) {
      const Nodes d = Set::load_nodes(couplings.positions, layout.inner_nodes + first) - x;
      const Coupling c = coupling_of(d, Set::load(layout.inner_rest_lengths + first),
                                     Set::load(layout.inner_stiffnesses + first),
                                     Set::load(layout.inner_dampings + first), couplings.h);
      Set::store(couplings.inner_along + first, c.along);
      Set::store(couplings.inner_across + first, c.across);
      block.add(d, c.along, c.across);
      Block inner;
      inner.add(d, c.along, c.across);
      for (std::uint32_t k = 0; k < slice.link_count; ++k) {
        const ProductLink& link = layout.links[slice.first_link + k];
        inner.add_weighted_to(virtual_blocks + kBlockNumbers * kLanes * link.virtual_node + lane,
                              Set::load(link.weights + lane));
      }
    }
    block.store(blocks + kBlockNumbers * kLanes * index + lane);
  }

  /// h J (p_j − p_i)
  static Nodes change(const Nodes& d, const Nodes& w, const Pack& along, const Pack& across) {
    const Pack s = along * dot(d, w);
    return {Set::fma(s, d.x, across * w.x), Set::fma(s, d.y, across * w.y),
            Set::fma(s, d.z, across * w.z)};
  }

  static void apply_part(const ProductLayout& layout, const Couplings& couplings, std::size_t index,
                         std::size_t lane, const float* masses, const float* p, float* out,
                         float* virtual_sums) {
    const Slice& slice = layout.slices[index];
    const std::size_t first = index * kLanes + lane;
    const Nodes x = Set::load_nodes(couplings.positions, layout.row_nodes + first);
    const Nodes p_i = Set::load_nodes(p, layout.row_nodes + first);
    Nodes sum = zero();  // of h J (p_j − p_i)
    for (std::size_t k = 0; k < slice.slots; ++k) {
      const std::size_t slot = (slice.first_slot + k) * kLanes + lane;
      const Nodes d = Set::load_nodes(couplings.positions, layout.neighbours + slot) - x;
      const Nodes w = Set::load_nodes(p, layout.neighbours + slot) - p_i;
      add_scaled(sum, Set::load(couplings.along + slot) * dot(d, w), d);
      add_scaled(sum, Set::load(couplings.across + slot), w);
    }
    if (layout.virtual_node_count > 0) {
      const Nodes d = Set::load_nodes(couplings.positions, layout.inner_nodes + first) - x;
      const Nodes w = Set::load_nodes(p, layout.inner_nodes + first) - p_i;
      const Nodes inner = change(d, w, Set::load(couplings.inner_along + first),
                                 Set::load(couplings.inner_across + first));
      sum = {sum.x + inner.x, sum.y + inner.y, sum.z + inner.z};
      for (std::uint32_t k = 0; k < slice.link_count; ++k) {
        const ProductLink& link = layout.links[slice.first_link + k];
        const Pack weight = Set::load(link.weights + lane);
        float* const to = virtual_sums + 3 * kLanes * link.virtual_node + lane;
        Set::store(to, Set::fma(weight, inner.x, Set::load(to)));
        Set::store(to + kLanes, Set::fma(weight, inner.y, Set::load(to + kLanes)));
        Set::store(to + 2 * kLanes, Set::fma(weight, inner.z, Set::load(to + 2 * kLanes)));
      }
    }
    const Pack mass = Set::load(masses + first);
    store_rows(layout, first, out,
               {mass * p_i.x - sum.x, mass * p_i.y - sum.y, mass * p_i.z - sum.z});
  }

  static void store_rows(const ProductLayout& layout, std::size_t first, float* out,
                         const Nodes& nodes) {
    if (first + kWidth <= layout.surface_node_count) {
      Set::store_nodes(out + 4 * first, nodes);
      return;
    }
    float lanes[4 * kWidth];
    Set::store_nodes(lanes, nodes);
    for (std::size_t i = 4 * first; i < 4 * layout.surface_node_count; ++i) {
      out[i] = lanes[i - 4 * first];
    }
  }

  struct Range {
    std::size_t begin, end;
  };
  static Range slices_of(const ProductLayout& layout, std::size_t chunk) {
    const std::size_t begin = chunk * layout.slices_per_chunk;
    const std::size_t end = begin + layout.slices_per_chunk;
    return {begin, end < layout.slice_count ? end : layout.slice_count};
  }

  static void linearise(const ProductLayout& layout, const Couplings& couplings, std::size_t chunk,
                        float* blocks, float* virtual_blocks) {
    for (std::size_t i = 0; i < kBlockNumbers * kLanes * layout.virtual_node_count; ++i) {
      virtual_blocks[i] = 0;
    }
    const auto [begin, end] = slices_of(layout, chunk);
    for (std::size_t slice = begin; slice < end; ++slice) {
      for (std::size_t lane = 0; lane < kLanes; lane += kWidth) {
        linearise_part(layout, couplings, slice, lane, blocks, virtual_blocks);
      }
    }
  }

  static void apply(const ProductLayout& layout, const Couplings& couplings, std::size_t chunk,
                    const float* masses, const float* p, float* out, float* virtual_sums) {
    for (std::size_t i = 0; i < 3 * kLanes * layout.virtual_node_count; ++i) virtual_sums[i] = 0;
    const auto [begin, end] = slices_of(layout, chunk);
    for (std::size_t slice = begin; slice < end; ++slice) {
      for (std::size_t lane = 0; lane < kLanes; lane += kWidth) {
        apply_part(layout, couplings, slice, lane, masses, p, out, virtual_sums);
      }
    }
  }

  static constexpr ProductFunctions functions{&linearise, &apply};
};

}  // namespace
}  // namespace palpate::deformation::kernel
