// The matrix of linear tetrahedra times a vector, for any instruction set: `Floats` of
// deformation/packs/vector3.h.
//
// A group's pack holds four pairs' rows side by side: with the row's node i and its neighbours j,
// the rows times p_j, summed over the lanes of each row, are what i gets; the rows times the
// numbers of p_i are what the four j get at once.
#pragma once

#include "deformation/elements/kernel/element_kernel_arrays.h"
#include "deformation/packs/vector3.h"

namespace palpate::deformation::kernel {
namespace {

using Quad = float __attribute__((vector_size(16)));
using QuadInMemory = float __attribute__((vector_size(16), aligned(4), may_alias));

inline Quad load_quad(const float* from) { return *reinterpret_cast<const QuadInMemory*>(from); }
inline void store_quad(float* to, const Quad& quad) { *reinterpret_cast<QuadInMemory*>(to) = quad; }
inline void add_quad(float* to, const Quad& quad) { store_quad(to, load_quad(to) + quad); }
inline Quad repeated(float x) { return Quad{x, x, x, x}; }

template <class Floats>
struct ElementProduct {
  using Pack = typename Floats::Pack;
  static constexpr std::size_t kLanes = kTetrahedronLanes, kWidth = Floats::kWidth;
  static constexpr std::size_t kPacks = kLanes / kWidth;

  /// Groups are taken one by one, not row by row: how many a row has cannot be foretold, and a
  /// branch that is would cost more than to sum up over lanes each time.
  template <bool kVolume>
  static void multiply_group(const ElementArrays& a, std::size_t row, const std::uint32_t* columns,
                             std::size_t group) {
    const float *const p = a.p + row, *const blocks = a.blocks + kBlockFloats * group;
    const Pack x = Floats::broadcast(p[0]), y = Floats::broadcast(p[1]),
               z = Floats::broadcast(p[2]);
    Pack sums[kPacks];
    for (std::size_t n = 0; n < kPacks; ++n) {
      const std::size_t lane = n * kWidth;
      const Pack there = Floats::gather_quads(a.p, columns + lane / 4);
      const Pack r0 = Floats::load(blocks + lane), r1 = Floats::load(blocks + kLanes + lane),
                 r2 = Floats::load(blocks + 2 * kLanes + lane);
      const Pack here = Floats::fma(r2, z, Floats::fma(r1, y, r0 * x));
      Floats::add_quads(a.product, columns + lane / 4, here);
      Pack change = Floats::broadcast(0);
      if constexpr (kVolume) {
        change = Floats::load(a.volume_gradients + kLanes * group + lane) * there;
      }
      const Vector4<Floats> lanes = Floats::transpose(r0 * there, r1 * there, r2 * there, change);
      sums[n] = (lanes.x + lanes.y) + (lanes.z + lanes.w);
    }
    add_quad(a.product + row, Floats::fold(sums));
  }

  /// p of the part's nodes, and product = A_ii p_i to begin with.
  static void multiply_diagonals(const ElementPart& part, const ElementArrays& a) {
    for (std::size_t slot = part.first_slot; slot < part.first_slot + part.slot_count; ++slot) {
      const Quad p = load_quad(a.vectors + 4 * part.nodes[slot]);
      const float* const d = a.diagonals + 12 * slot;
      store_quad(a.p + 4 * slot, p);
      store_quad(a.product + 4 * slot,
                 (load_quad(d) * repeated(p[0]) + load_quad(d + 4) * repeated(p[1])) +
                     load_quad(d + 8) * repeated(p[2]));
    }
    store_quad(a.product + 4 * (part.first_slot + part.slot_count), repeated(0));
  }

  template <bool kVolume>
  static void multiply(const ElementPart& the_part, const ElementArrays& arrays) {
    const ElementPart part = the_part;  // copies: what is stored cannot change them
    const ElementArrays a = arrays;
    multiply_diagonals(part, a);
    for (std::size_t g = 0; g < part.group_count; ++g) {
      multiply_group<kVolume>(a, part.rows[g], part.columns + kGroupPairs * g,
                              part.first_group + g);
    }
    if constexpr (!kVolume) return;
    for (std::size_t i = part.first_slot; i < part.first_slot + part.slot_count; ++i) {
      a.rates[i] = a.product[4 * i + 3];  // cppcheck-suppress unreadVariable; another part reads it
    }
  }

  static void push_group(const ElementArrays& a, std::size_t row, const std::uint32_t* columns,
                         std::size_t group) {
    const Pack rate = Floats::broadcast(a.weighted_rates[row]);
    Pack sums[kPacks];
    for (std::size_t n = 0; n < kPacks; ++n) {
      const std::size_t lane = n * kWidth;
      const Pack gradients = Floats::load(a.volume_gradients + kLanes * group + lane);
      const Pack there = Floats::gather_quads(a.weighted_rates, columns + lane / 4);
      sums[n] = Floats::fnma(gradients, there, Floats::broadcast(0));
      Floats::add_quads(a.product, columns + lane / 4, gradients * rate);
    }
    add_quad(a.product + row, Floats::fold(sums));
  }

  static void push(const ElementPart& the_part, const ElementArrays& arrays) {
    const ElementPart part = the_part;
    const ElementArrays a = arrays;
    weigh_rates(part, a);
    for (std::size_t g = 0; g < part.group_count; ++g) {
      push_group(a, part.rows[g], part.columns + kGroupPairs * g, part.first_group + g);
    }
    for (std::size_t k = 0; k < part.open_count; ++k) {
      const OpenPair& open = part.open_pairs[k];
      add_quad(a.product + open.row, load_quad(a.open + 4 * (part.first_open + k)) *
                                         load_quad(a.weighted_rates + open.column));
    }
    for (std::size_t k = 0; k < part.open_slot_count; ++k) {
      const std::size_t slot = part.open_slots[k];
      const float* const d = a.diagonals + 12 * slot;
      const Quad own{d[3], d[7], d[11], 0};
      add_quad(a.product + 4 * slot, own * load_quad(a.weighted_rates + 4 * slot));
    }
  }

  static void weigh_rates(const ElementPart& part, const ElementArrays& a) {
    for (std::size_t slot = part.first_slot; slot < part.first_slot + part.slot_count; ++slot) {
      store_quad(a.weighted_rates + 4 * slot, repeated(a.weights[slot] * a.rates[slot]));
    }
    for (std::size_t k = 0; k < part.shared_count; ++k) {
      const SharedSlot& shared = part.shared[k];
      float rate = 0;
      for (std::size_t n = shared.first; n < shared.last; ++n) rate += a.rates[part.node_slots[n]];
      store_quad(a.weighted_rates + 4 * shared.slot, repeated(a.weights[shared.slot] * rate));
    }
  }

  /// What assembly leaves in lane 3.
  static Quad column_gradient(const float* block) {
    return Quad{block[3], block[kLanes + 3], block[2 * kLanes + 3], 0};
  }
  static Quad fourth(const Quad& numbers, float last) {
    return Quad{numbers[0], numbers[1], numbers[2], last};
  }
  /// rows += w g gᵀ
  static void add_square(float w, const Quad& g, float* rows) {
    const Quad weighted = repeated(w) * g;
    add_quad(rows, repeated(g[0]) * weighted);
    add_quad(rows + 4, repeated(g[1]) * weighted);
    add_quad(rows + 8, repeated(g[2]) * weighted);
  }

  /// Where rings close, lane 3 becomes minus the volume gradient to the bit; elsewhere what is left
  /// of their sum is kept. Then the nodes' blocks with Σ_a w_a (∂v_a/∂x_b)(∂v_a/∂x_b)ᵀ of the
  /// part's pairs.
  static void finish_volumes(const ElementPart& the_part, const ElementArrays& arrays) {
    const ElementPart part = the_part;
    const ElementArrays a = arrays;
    for (std::size_t k = 0; k < part.open_count; ++k) {
      const std::size_t pair = part.open_pairs[k].pair;
      store_quad(a.open + 4 * (part.first_open + k), column_gradient(a.blocks + block_place(pair)) +
                                                         load_quad(a.volume_gradients + 4 * pair));
    }
    for (std::size_t slot = part.first_slot; slot < part.first_slot + part.slot_count; ++slot) {
      const float* const d = a.diagonals + 12 * slot;
      float* const whole = a.whole_diagonals + 12 * slot;
      for (std::size_t row = 0; row < 12; row += 4) store_quad(whole + row, load_quad(d + row));
      add_square(a.weights[slot], Quad{d[3], d[7], d[11], 0}, whole);
    }
    for (std::size_t g = 0; g < part.group_count; ++g) {
      const float row_weight = a.weights[part.rows[g] / 4];
      for (std::size_t k = 0; k < kGroupPairs; ++k) {
        const std::size_t pair = kGroupPairs * (part.first_group + g) + k;
        const std::uint32_t column = part.columns[kGroupPairs * g + k];
        const Quad gradient = load_quad(a.volume_gradients + 4 * pair);
        float* block = a.blocks + block_place(pair);
        for (int row = 0; row < 3; ++row, block += kLanes) {
          store_quad(block, fourth(load_quad(block), -gradient[row]));
        }
        add_square(row_weight, gradient, a.whole_diagonals + 3 * column);
        add_square(a.weights[column / 4], gradient, a.whole_diagonals + 3 * part.rows[g]);
      }
    }
    for (std::size_t k = 0; k < part.open_count; ++k) {
      const OpenPair& open = part.open_pairs[k];
      float* const block = a.blocks + block_place(open.pair);
      const Quad minus = column_gradient(block);
      const Quad gradient = minus + load_quad(a.open + 4 * (part.first_open + k));
      for (std::size_t row = 0; row < 3; ++row) block[kLanes * row + 3] = gradient[row];
      float* const whole = a.whole_diagonals + 3 * open.row;
      add_square(-a.weights[open.column / 4], minus, whole);
      add_square(a.weights[open.column / 4], gradient, whole);
    }
  }

  static void collect(const ElementPart& the_part, const ElementArrays& arrays) {
    const ElementPart part = the_part;
    const ElementArrays a = arrays;
    const Quad three{1, 1, 1, 0};
    for (std::size_t k = 0; k < part.owned_count; ++k) {
      const std::size_t slot = part.owned[k];
      store_quad(a.products + 4 * part.nodes[slot], load_quad(a.product + 4 * slot) * three);
    }
    for (std::size_t k = 0; k < part.node_merge_count; ++k) {
      const Merge& merge = part.node_merges[k];
      add_quad(a.products + 4 * part.nodes[merge.to],
               load_quad(a.product + 4 * merge.from) * three);
    }
  }
};

}  // namespace
}  // namespace palpate::deformation::kernel
