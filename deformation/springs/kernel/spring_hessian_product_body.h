// The spring product for any instruction set: included once by each spring_kernel_<set>.cpp, whose
// `Floats` are the `Set` (spring_kernel_body.h).
#pragma once

#include "deformation/springs/kernel/spring_hessian_product_arrays.h"
#include "deformation/springs/kernel/spring_kernel_body.h"

namespace palpate::deformation::kernel {
namespace {

template <class Set>
struct Product {
  using Pack = typename Set::Pack;
  using Nodes = Vector3<Set>;
  static constexpr std::size_t kWidth = Set::kWidth;

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

  /// h J of springs along d: h² k (1 − l₀/l)₊ across, (h c + h² k − across)/l² along.
  static Coupling coupling_of(const Nodes& d, const Pack& rest_length, const Pack& stiffness,
                              const Pack& damping, float h) {
    const Pack step = Set::broadcast(h);
    const Pack root = inverse_root<Set>(dot(d, d, Set::broadcast(kTinySquare)));
    const Pack stretch = Set::fnma(rest_length, root, Set::broadcast(1));
    const Pack h_k = step * stiffness;
    const Pack pulled = stretch + Set::absolute(stretch);
    const Pack across = Set::broadcast(0.5f) * step * h_k * pulled;
    return {(step * (damping + h_k) - across) * (root * root), across};
  }

  /// The upper half of a number's bits, rounded. Half-springs of one spring are rounded alike, so
  /// the matrix stays symmetric, and positive, as both numbers are.
  static constexpr std::uint32_t kUpper = 0xffff0000u;
  static Pack rounded(const Pack& x) { return Set::of_bits((Set::bits(x) + 0x8000u) & kUpper); }
  static Pack packed(const Coupling& c) {
    return Set::of_bits(Set::bits(c.along) | (Set::bits(c.across) >> 16));
  }
  static Coupling unpacked(const Pack& pair) {
    return {Set::of_bits(Set::bits(pair) & kUpper), Set::of_bits(Set::bits(pair) << 16)};
  }

  static void linearise_slots(const Layout& layout, const Couplings& couplings, std::size_t from,
                              std::size_t to, std::size_t lane, float stiffness, float time,
                              const Nodes& x, Block& block) {
    const Pack k = Set::broadcast(stiffness), c = Set::broadcast(couplings.damping * time) * k;
    for (std::size_t slot = from; slot < to; ++slot) {
      const std::size_t at = slot * kLanes + lane;
      const Nodes d = Set::load_nodes(couplings.nodes, layout.neighbours + at) - x;
      Coupling coupling = coupling_of(d, Set::load(layout.rest_lengths + at), k, c, couplings.h);
      coupling = {rounded(coupling.along), rounded(coupling.across)};
      Set::store(couplings.pairs + at, packed(coupling));
      block.add(d, coupling.along, coupling.across);
    }
  }

  static void linearise_inner(const Layout& layout, const Couplings& couplings, const Slice& slice,
                              std::size_t first, std::size_t lane, const Nodes& x,
                              float* virtual_blocks, Block& block) {
    const Nodes d = Set::load_nodes(couplings.nodes, layout.inner_nodes + first) - x;
    const Pack damping = Set::broadcast(couplings.damping);
    const Coupling c = coupling_of(d, Set::load(layout.inner_rest_lengths + first),
                                   Set::load(layout.inner_stiffnesses + first),
                                   damping * Set::load(layout.inner_dampings + first), couplings.h);
    Set::store(couplings.inner_along + first, c.along);
    Set::store(couplings.inner_across + first, c.across);
    block.add(d, c.along, c.across);
    Block inner;
    inner.add(d, c.along, c.across);
    for (std::uint32_t k = 0; k < slice.link_count; ++k) {
      const Link& link = layout.links[slice.first_link + k];
      inner.add_weighted_to(virtual_blocks + kBlockNumbers * kLanes * link.virtual_node + lane,
                            Set::load(link.weights + lane));
    }
  }

  static void linearise_part(const Layout& layout, const Couplings& couplings, std::size_t index,
                             std::size_t lane, float* blocks, float* virtual_blocks) {
    const Slice& slice = layout.slices[index];
    const std::size_t first = index * kLanes + lane;
    const std::size_t bending = slice.first_slot + slice.structural_slots;
    const Nodes x = Set::load_nodes(couplings.nodes, layout.row_nodes + first);
    Block block;
    linearise_slots(layout, couplings, slice.first_slot, bending, lane, layout.structural_stiffness,
                    layout.structural_damping_time, x, block);
    linearise_slots(layout, couplings, bending, slice.first_slot + slice.slots, lane,
                    layout.bending_stiffness, layout.bending_damping_time, x, block);
    if (layout.virtual_node_count > 0) {
      linearise_inner(layout, couplings, slice, first, lane, x, virtual_blocks, block);
    }
    block.store(blocks + kBlockNumbers * kLanes * index + lane);
  }

  /// sum += h J (p_j − p_i)
  static void add_change(const NodePairs<Set>& here, const NodePairs<Set>& there, const Coupling& c,
                         Nodes& sum) {
    const Nodes d = there.first - here.first, w = there.second - here.second;
    add_scaled(sum, c.along * dot(d, w), d);
    add_scaled(sum, c.across, w);
  }

  /// Of the inner springs, also into the virtual nodes' sums.
  static Nodes inner_change(const Layout& layout, const Couplings& couplings, const Slice& slice,
                            std::size_t first, std::size_t lane, const NodePairs<Set>& here,
                            float* virtual_sums) {
    Nodes change = no_vectors<Set>();
    add_change(
        here, Set::load_pairs(couplings.nodes, layout.inner_nodes + first),
        {Set::load(couplings.inner_along + first), Set::load(couplings.inner_across + first)},
        change);
    for (std::uint32_t k = 0; k < slice.link_count; ++k) {
      const Link& link = layout.links[slice.first_link + k];
      const Pack weight = Set::load(link.weights + lane);
      float* const to = virtual_sums + 3 * kLanes * link.virtual_node + lane;
      Set::store(to, Set::fma(weight, change.x, Set::load(to)));
      Set::store(to + kLanes, Set::fma(weight, change.y, Set::load(to + kLanes)));
      Set::store(to + 2 * kLanes, Set::fma(weight, change.z, Set::load(to + 2 * kLanes)));
    }
    return change;
  }

  /// Each neighbour is loaded before the one ahead of it is added.
  static void apply_part(const Layout& layout, const Couplings& couplings, std::size_t index,
                         std::size_t lane, const float* masses, float* out, float* virtual_sums,
                         float* dots) {
    const Slice& slice = layout.slices[index];
    const std::size_t first = index * kLanes + lane;
    const NodePairs<Set> here = Set::load_pairs(couplings.nodes, layout.row_nodes + first);
    Nodes sum = no_vectors<Set>();  // of h J (p_j − p_i)
    std::size_t at = slice.first_slot * kLanes + lane;
    const std::size_t last = at + (slice.slots - 1) * kLanes;
    NodePairs<Set> next = Set::load_pairs(couplings.nodes, layout.neighbours + at);
    for (; at < last; at += kLanes) {
      const NodePairs<Set> now = next;
      next = Set::load_pairs(couplings.nodes, layout.neighbours + at + kLanes);
      add_change(here, now, unpacked(Set::load(couplings.pairs + at)), sum);
    }
    add_change(here, next, unpacked(Set::load(couplings.pairs + at)), sum);
    if (layout.virtual_node_count > 0) {
      const Nodes inner = inner_change(layout, couplings, slice, first, lane, here, virtual_sums);
      sum = {sum.x + inner.x, sum.y + inner.y, sum.z + inner.z};
    }
    const Pack mass = Set::load(masses + first);
    const Nodes& p = here.second;
    const Nodes product{mass * p.x - sum.x, mass * p.y - sum.y, mass * p.z - sum.z};
    store_rows(layout, first, out, product);
    Set::store(dots + lane, dot(p, product, Set::load(dots + lane)));
  }

  static void store_rows(const Layout& layout, std::size_t first, float* out, const Nodes& nodes) {
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

  static void linearise(const Layout& layout, const Couplings& couplings, const SliceList& list,
                        float* blocks, float* virtual_blocks) {
    for (std::size_t i = 0; i < kBlockNumbers * kLanes * layout.virtual_node_count; ++i) {
      virtual_blocks[i] = 0;
    }
    for (std::size_t i = 0; i < list.count; ++i) {
      for (std::size_t lane = 0; lane < kLanes; lane += kWidth) {
        linearise_part(layout, couplings, list.slices[i], lane, blocks, virtual_blocks);
      }
    }
  }

  static void apply(const Layout& layout, const Couplings& couplings, const SliceList& list,
                    const float* masses, float* out, float* virtual_sums, float* dots) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) dots[lane] = 0;
    for (std::size_t i = 0; i < 3 * kLanes * layout.virtual_node_count; ++i) virtual_sums[i] = 0;
    for (std::size_t i = 0; i < list.count; ++i) {
      for (std::size_t lane = 0; lane < kLanes; lane += kWidth) {
        apply_part(layout, couplings, list.slices[i], lane, masses, out, virtual_sums, dots);
      }
    }
  }

  static constexpr ProductFunctions functions{&linearise, &apply};
};

}  // namespace
}  // namespace palpate::deformation::kernel
