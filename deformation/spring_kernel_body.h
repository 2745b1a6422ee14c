// The spring kernel for any instruction set: included once by each spring_kernel_<set>.cpp, which
// is compiled for that set and gives `Set`, a struct of kWidth lanes:
//
//   Pack                        kWidth doubles with + − * elementwise
//   load, store, broadcast      a Pack from and to memory
//   fma(a, b, c), fnma(a, b, c) c + a b and c − a b, rounded once where the CPU can
//   load_nodes(base, offsets)   x, y, z of kWidth nodes of three doubles each
//   store_nodes(base, nodes)    of kWidth consecutive nodes
//   inverse_root_guess(x)       (double)(1 / √(float)x), each operation as IEEE 754 defines it
//   keep_below(values, a, b)    a < b ? values : 0
//
// A slice is worked through in kLanes / kWidth parts. Every lane does the same operations in the
// same order whatever the width, and sums over lanes are taken in lane order, so all sets that fuse
// multiply and add give the same bits.
#pragma once

#include "deformation/spring_kernel_coordinates.h"
#include "deformation/spring_kernel_vector3.h"

namespace palpate::deformation::kernel {
namespace {

template <class Set>
struct Kernel {
  using Pack = typename Set::Pack;
  using Nodes = Vector3<Set>;
  static constexpr std::size_t kWidth = Set::kWidth;

  static Nodes zero() {
    const Pack none = Set::broadcast(0);
    return {none, none, none};
  }

  struct Range {
    std::size_t begin, end;
  };
  static Range slices_of(const Layout& layout, std::size_t chunk) {
    const std::size_t begin = chunk * layout.slices_per_chunk;
    const std::size_t end = begin + layout.slices_per_chunk;
    return {begin, end < layout.slice_count ? end : layout.slice_count};
  }

  /// A neighbour on its way: what the loads gave and the root's guess.
  struct Pending {
    Nodes d;  ///< x_j − x_i
    Pack square, rate, guess;
  };

  /// A surface node's sums while its row is read.
  struct Row {
    Nodes position, velocity;
    Nodes structural = zero(), bending = zero();  ///< Σ pull d: force over stiffness
    Nodes gradient = zero();                      ///< Σ d_j × d_j+1 = 6 g
    Nodes force = zero();                         ///< of the inner spring [N]
  };

  static Pending begin(const double* positions, const double* velocities,
                       const std::uint32_t* offsets, const Row& row) {
    Pending p;
    p.d = Set::load_nodes(positions, offsets) - row.position;
    const Nodes w = Set::load_nodes(velocities, offsets) - row.velocity;
    p.square = dot(p.d, p.d, Set::broadcast(kTinySquare));
    p.guess = Set::inverse_root_guess(p.square);
    p.rate = dot(p.d, w);
    return p;
  }

  /// 1/√x to the last bits: the guess y is good to 1e-7; with e = 1 − x y²,
  /// 1/√x = y (1 − e)^-½ = y + y e (½ + ⅜ e) + O(e³).
  static Pack inverse_root(const Pack& x, const Pack& y) {
    const Pack e = Set::fnma(x, y * y, Set::broadcast(1));
    return Set::fma(y * e, Set::fma(Set::broadcast(0.375), e, Set::broadcast(0.5)), y);
  }

  /// Tension over length and stiffness: with l = |d|,  1 − l₀/l + τ (w·d)/l².
  static Pack pull(const Pending& p, const Pack& rest_length, const Pack& time) {
    const Pack r = inverse_root(p.square, p.guess);
    return Set::fma(Set::fma(time * p.rate, r, -rest_length), r, Set::broadcast(1));
  }

  /// Force of the inner springs on the rows [N]; its opposite goes to the virtual nodes.
  static void add_inner(const Layout& layout, const Slice& slice, std::size_t first,
                        std::size_t lane, const Pending& now, double* virtual_forces, Row& row) {
    const Pack r = inverse_root(now.square, now.guess);
    const Pack one = Set::broadcast(1);
    const Pack s = Set::load(layout.inner_stiffnesses + first) *
                       (one - Set::load(layout.inner_rest_lengths + first) * r) +
                   Set::load(layout.inner_dampings + first) * now.rate * r * r;
    row.force = {s * now.d.x, s * now.d.y, s * now.d.z};
    for (std::uint32_t k = 0; k < slice.link_count; ++k) {
      const Link& link = layout.links[slice.first_link + k];
      double* const sum = virtual_forces + 3 * kLanes * link.virtual_node + lane;
      const Pack weight = Set::load(link.weights + lane);
      Set::store(sum, Set::fnma(weight, row.force.x, Set::load(sum)));
      Set::store(sum + kLanes, Set::fnma(weight, row.force.y, Set::load(sum + kLanes)));
      Set::store(sum + 2 * kLanes, Set::fnma(weight, row.force.z, Set::load(sum + 2 * kLanes)));
    }
  }

  static void store_rows(const Layout& layout, std::size_t first, double* base,
                         const Nodes& nodes) {
    if (first + kWidth <= layout.surface_node_count) {
      Set::store_nodes(base + 3 * first, nodes);
      return;
    }
    double lanes[3][kWidth];
    Set::store(lanes[0], nodes.x);
    Set::store(lanes[1], nodes.y);
    Set::store(lanes[2], nodes.z);
    for (std::size_t lane = 0; first + lane < layout.surface_node_count; ++lane) {
      for (int axis = 0; axis < 3; ++axis) base[3 * (first + lane) + axis] = lanes[axis][lane];
    }
  }

  /// A part of a slice, and what its neighbours add to it.
  struct Part {
    const Layout& layout;
    const Step& step;
    const Slice& slice;
    std::size_t first;  ///< row
    std::size_t slot;   ///< of the first neighbours, times kLanes, at the part's first lane
    Row row;

    Part(const Layout& l, const Step& s, std::size_t index, std::size_t lane)
        : layout(l),
          step(s),
          slice(l.slices[index]),
          first(index * kLanes + lane),
          slot(slice.first_slot * kLanes + lane) {
      row.position = Set::load_nodes(step.positions, layout.row_nodes + first);
      row.velocity = Set::load_nodes(step.velocities, layout.row_nodes + first);
    }

    Pending begin_slot(std::size_t k) const {
      return begin(step.positions, step.velocities, layout.neighbours + slot + k * kLanes, row);
    }
    Pack rest_length(std::size_t k) const {
      return Set::load(layout.rest_lengths + slot + k * kLanes);
    }

    /// @param next_of_ring  d of the next neighbour
    template <bool kVolume>
    void add_ring(const Pending& now, const Nodes& next_of_ring, std::size_t k) {
      const Pack s = pull(now, rest_length(k), Set::broadcast(layout.structural_damping_time));
      const Pack number = Set::broadcast(static_cast<double>(k));
      const Pack ring_size = Set::load(layout.ring_sizes + first);
      add_scaled(row.structural, Set::keep_below(s, number, ring_size), now.d);
      if constexpr (kVolume) add_cross(row.gradient, now.d, next_of_ring);
    }

    void add_bending(const Pending& now, std::size_t k) {
      const Pack time = Set::broadcast(layout.bending_damping_time);
      add_scaled(row.bending, pull(now, rest_length(k), time), now.d);
    }

    /// Forces and 6 g, to where v̂ and g will be.
    template <bool kVolume>
    void store() {
      add_scaled(row.force, Set::broadcast(layout.structural_stiffness), row.structural);
      add_scaled(row.force, Set::broadcast(layout.bending_stiffness), row.bending);
      store_rows(layout, first, step.new_velocities, row.force);
      if constexpr (kVolume) store_rows(layout, first, step.gradient, row.gradient);
    }
  };

  /// Each neighbour's loads and root are begun before the one ahead of it is added: the root takes
  /// longer than all the rest.
  template <bool kVolume>
  static void step_part(const Layout& layout, const Step& step, std::size_t slice_index,
                        std::size_t lane, double* virtual_forces) {
    Part part(layout, step, slice_index, lane);
    const std::size_t ring = part.slice.ring_slots, slots = part.slice.slots;
    Pending now, next;
    if (layout.virtual_node_count > 0) {
      const std::uint32_t* const offsets = layout.inner_nodes + part.first;
      now = begin(step.virtual_positions, step.virtual_velocities, offsets, part.row);
      next = part.begin_slot(0);
      add_inner(layout, part.slice, part.first, lane, now, virtual_forces, part.row);
    } else {
      next = part.begin_slot(0);
    }
    const Nodes first_of_ring = next.d;
    for (std::size_t k = 1; k < ring; ++k) {
      now = next;
      next = part.begin_slot(k);
      part.template add_ring<kVolume>(now, next.d, k - 1);
    }
    now = next;
    if (slots > ring) next = part.begin_slot(ring);
    part.template add_ring<kVolume>(now, first_of_ring, ring - 1);
    for (std::size_t k = ring + 1; k < slots; ++k) {
      now = next;
      next = part.begin_slot(k);
      part.add_bending(now, k - 1);
    }
    if (slots > ring) part.add_bending(next, slots - 1);
    part.template store<kVolume>();
  }

  template <bool kVolume>
  static void step_chunk(const Layout& layout, const Step& step, std::size_t chunk) {
    const std::size_t stride = 3 * kLanes * layout.virtual_node_count;
    double* const virtual_forces = step.virtual_forces + stride * chunk;
    for (std::size_t i = 0; i < stride; ++i) virtual_forces[i] = 0;
    const auto [begin, end] = slices_of(layout, chunk);
    for (std::size_t slice = begin; slice < end; ++slice) {
      for (std::size_t lane = 0; lane < kLanes; lane += kWidth) {
        step_part<kVolume>(layout, step, slice, lane, virtual_forces);
      }
    }
    const std::size_t last = end < layout.slice_count ? kLanes * end : layout.surface_node_count;
    step.sums[chunk] = finish_slices<kVolume>(layout, step, 3 * kLanes * begin, 3 * last);
  }

  /// (l − l₀)²
  static Pack squared_stretch(const double* positions, const std::uint32_t* offsets,
                              const Nodes& position, const Pack& rest_length) {
    const Nodes d = Set::load_nodes(positions, offsets) - position;
    const Pack square = dot(d, d, Set::broadcast(kTinySquare));
    const Pack length = square * inverse_root(square, Set::inverse_root_guess(square));
    const Pack stretch = length - rest_length;
    return stretch * stretch;
  }

  static double chunk_energy(const Layout& layout, const Step& step, std::size_t chunk) {
    double lanes[kLanes] = {};
    const auto [begin, end] = slices_of(layout, chunk);
    for (std::size_t index = begin; index < end; ++index) {
      const Slice& slice = layout.slices[index];
      for (std::size_t lane = 0; lane < kLanes; lane += kWidth) {
        const std::size_t first = index * kLanes + lane;
        const Nodes x = Set::load_nodes(step.positions, layout.row_nodes + first);
        const Pack ring_size = Set::load(layout.ring_sizes + first), none = Set::broadcast(0);
        Pack structural = none, bending = none, inner = none;
        for (std::size_t k = 0; k < slice.slots; ++k) {
          const std::size_t slot = (slice.first_slot + k) * kLanes + lane;
          const Pack e = squared_stretch(step.positions, layout.neighbours + slot, x,
                                         Set::load(layout.rest_lengths + slot));
          const Pack number = Set::broadcast(static_cast<double>(k));
          if (k < slice.ring_slots) structural = structural + Set::keep_below(e, number, ring_size);
          if (k >= slice.ring_slots) bending = bending + e;
        }
        if (layout.virtual_node_count > 0) {
          inner = squared_stretch(step.virtual_positions, layout.inner_nodes + first, x,
                                  Set::load(layout.inner_rest_lengths + first)) *
                  Set::load(layout.inner_stiffnesses + first);
        }
        const Pack twice = structural * Set::broadcast(layout.structural_stiffness) +
                           bending * Set::broadcast(layout.bending_stiffness) + inner + inner;
        Set::store(lanes + lane, Set::load(lanes + lane) + twice);
      }
    }
    double total = 0;
    for (const double value : lanes) total += value;
    return total / 4;
  }

  static constexpr Functions functions{&step_chunk<true>, &step_chunk<false>, &move, &chunk_energy};
};

}  // namespace
}  // namespace palpate::deformation::kernel
