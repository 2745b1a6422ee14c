// What springs pull, and the volume's gradient with them: the spring kernel's part in float. `Set`
// as `Floats` in spring_kernel_body.h.
#pragma once

#include "deformation/packs/vector3.h"
#include "deformation/springs/kernel/spring_kernel_arrays.h"

namespace palpate::deformation::kernel {
namespace {

/// Slices of a chunk.
struct SliceRange {
  std::size_t begin, end;
};
inline SliceRange slices_of(const Layout& layout, std::size_t chunk) {
  const std::size_t begin = chunk * layout.slices_per_chunk;
  const std::size_t end = begin + layout.slices_per_chunk;
  return {begin, end < layout.slice_count ? end : layout.slice_count};
}

/// 1/√x to the last bits but one: the guess y, from half the exponent, is good to 3.5 %; with e = 1
/// − x y², 1/√x = y (1 − e)^-½ = y + y e (½ + ⅜ e) + O(e³), and once more y + ½ y e.
template <class Set>
inline typename Set::Pack inverse_root(const typename Set::Pack& x) {
  using Pack = typename Set::Pack;
  const Pack one = Set::broadcast(1), half = Set::broadcast(0.5f);
  const Pack y = Set::of_bits(0x5f375a86u - (Set::bits(x) >> 1));
  const Pack e = Set::fnma(x * y, y, one);
  const Pack z = Set::fma(y * e, Set::fma(Set::broadcast(0.375f), e, half), y);
  return Set::fma(z * half, Set::fnma(x * z, z, one), z);
}

template <class Set>
inline Vector3<Set> no_vectors() {
  const typename Set::Pack none = Set::broadcast(0);
  return {none, none, none};
}

/// A vector of each row of a slice.
struct Rows {
  float x[kLanes], y[kLanes], z[kLanes];
};

/// Springs and the volume's gradient, in float.
template <class Set>
struct Springs {
  using Pack = typename Set::Pack;
  using Nodes = Vector3<Set>;
  static constexpr std::size_t kWidth = Set::kWidth;

  /// A spring from here to a neighbour: d = x_j − x_i, l² and d·w, w = v_j − v_i.
  struct Spring {
    Nodes d;
    Pack square, rate;
  };

  static Spring spring_to(const float* nodes, const std::uint32_t* offsets,
                          const NodePairs<Set>& here) {
    const NodePairs<Set> there = Set::load_pairs(nodes, offsets);
    Spring spring;
    spring.d = there.first - here.first;
    spring.square = dot(spring.d, spring.d, Set::broadcast(kTinySquare));
    spring.rate = dot(spring.d, there.second - here.second);
    return spring;
  }

  /// Adds pull d of the springs [at, at + kWidth), pull = tension over length and stiffness: with
  /// l = |d|, 1 − l₀/l + τ (w·d)/l². @return d
  static Nodes add_spring(const Layout& layout, const Step& step, std::size_t at, const Pack& time,
                          const NodePairs<Set>& here, Nodes& sum) {
    const Spring spring = spring_to(step.nodes, layout.neighbours + at, here);
    const Pack r = inverse_root<Set>(spring.square);
    const Pack shortfall = Set::fma(time * spring.rate, r, -Set::load(layout.rest_lengths + at));
    add_scaled(sum, Set::fma(shortfall, r, Set::broadcast(1)), spring.d);
    return spring.d;
  }

  /// d, where a row is shorter the one before: its ring goes on only behind the padding.
  static Nodes unpadded(const Layout& layout, std::size_t at, const Nodes& d, const Nodes& before) {
    const Pack length = Set::load(layout.rest_lengths + at), none = Set::broadcast(kPaddingLength);
    return {Set::larger(length, none, d.x, before.x), Set::larger(length, none, d.y, before.y),
            Set::larger(length, none, d.z, before.z)};
  }

  /// Σ pull d of the structural springs, and the ring Σ d_j × d_j+1 of the same neighbours.
  template <bool kVolume>
  static void add_structural(const Layout& layout, const Step& step, const Slice& slice,
                             std::size_t lane, const NodePairs<Set>& here, Nodes& sum,
                             Nodes& ring) {
    const Pack time = Set::broadcast(layout.structural_damping_time);
    const std::size_t start = slice.first_slot * kLanes + lane;
    const Nodes first = add_spring(layout, step, start, time, here, sum);
    Nodes before = first;
    for (std::size_t slot = 1; slot < slice.structural_slots; ++slot) {
      const std::size_t at = start + slot * kLanes;
      Nodes d = add_spring(layout, step, at, time, here, sum);
      if constexpr (kVolume) {
        if (slot >= slice.shortest_ring) d = unpadded(layout, at, d, before);
        add_cross(ring, before, d);
        before = d;
      }
    }
    if constexpr (kVolume) add_cross(ring, before, first);
  }

  static void add_bending(const Layout& layout, const Step& step, const Slice& slice,
                          std::size_t lane, const NodePairs<Set>& here, Nodes& sum) {
    const Pack time = Set::broadcast(layout.bending_damping_time);
    for (std::size_t slot = slice.structural_slots; slot < slice.slots; ++slot) {
      add_spring(layout, step, (slice.first_slot + slot) * kLanes + lane, time, here, sum);
    }
  }

  /// Force of the inner springs on the rows [N]; its opposite goes to the virtual nodes.
  static Nodes inner_force(const Layout& layout, const Step& step, const Slice& slice,
                           std::size_t first, std::size_t lane, const NodePairs<Set>& here,
                           float* virtual_forces) {
    const Spring spring = spring_to(step.nodes, layout.inner_nodes + first, here);
    const Pack r = inverse_root<Set>(spring.square);
    const Pack one = Set::broadcast(1);
    const Pack s = Set::load(layout.inner_stiffnesses + first) *
                       (one - Set::load(layout.inner_rest_lengths + first) * r) +
                   Set::load(layout.inner_dampings + first) * spring.rate * r * r;
    const Nodes force{s * spring.d.x, s * spring.d.y, s * spring.d.z};
    for (std::uint32_t k = 0; k < slice.link_count; ++k) {
      const Link& link = layout.links[slice.first_link + k];
      float* const sum = virtual_forces + 3 * kLanes * link.virtual_node + lane;
      const Pack weight = Set::load(link.weights + lane);
      Set::store(sum, Set::fnma(weight, force.x, Set::load(sum)));
      Set::store(sum + kLanes, Set::fnma(weight, force.y, Set::load(sum + kLanes)));
      Set::store(sum + 2 * kLanes, Set::fnma(weight, force.z, Set::load(sum + 2 * kLanes)));
    }
    return force;
  }

  static void store(const Nodes& nodes, std::size_t lane, Rows& to) {
    Set::store(to.x + lane, nodes.x);
    Set::store(to.y + lane, nodes.y);
    Set::store(to.z + lane, nodes.z);
  }

  /// Forces on kWidth rows and 6 g.
  template <bool kVolume>
  static void add_part(const Layout& layout, const Step& step, std::size_t index, std::size_t lane,
                       float* virtual_forces, Rows& forces, Rows& rings) {
    const Slice& slice = layout.slices[index];
    const std::size_t first = index * kLanes + lane;
    const NodePairs<Set> here = Set::load_pairs(step.nodes, layout.row_nodes + first);
    Nodes force = no_vectors<Set>(), sum = force, ring = force;
    if (layout.virtual_node_count > 0) {
      force = inner_force(layout, step, slice, first, lane, here, virtual_forces);
    }
    add_structural<kVolume>(layout, step, slice, lane, here, sum, ring);
    add_scaled(force, Set::broadcast(layout.structural_stiffness), sum);
    if constexpr (kVolume) store(ring, lane, rings);
    sum = no_vectors<Set>();
    add_bending(layout, step, slice, lane, here, sum);
    add_scaled(force, Set::broadcast(layout.bending_stiffness), sum);
    store(force, lane, forces);
  }

  /// Forces on the rows of a slice [N] and, with volume, 6 g [m²].
  template <bool kVolume>
  static void add_slice(const Layout& layout, const Step& step, std::size_t index,
                        float* virtual_forces, Rows& forces, Rows& rings) {
    for (std::size_t lane = 0; lane < kLanes; lane += kWidth) {
      add_part<kVolume>(layout, step, index, lane, virtual_forces, forces, rings);
    }
  }

  /// (l − l₀)²
  static Pack squared_stretch(const float* nodes, const std::uint32_t* offsets,
                              const Nodes& position, const Pack& rest_length) {
    const Nodes d = Set::load_nodes(nodes, offsets) - position;
    const Pack square = dot(d, d, Set::broadcast(kTinySquare));
    const Pack stretch = Set::fma(square, inverse_root<Set>(square), -rest_length);
    return stretch * stretch;
  }

  static void add_energy(const Layout& layout, const Step& step, std::size_t index,
                         std::size_t lane, float* twice) {
    const Slice& slice = layout.slices[index];
    const std::size_t first = index * kLanes + lane;
    const Nodes x = Set::load_nodes(step.nodes, layout.row_nodes + first);
    Pack structural = Set::broadcast(0), bending = structural, inner = structural;
    for (std::size_t k = 0; k < slice.slots; ++k) {
      const std::size_t slot = (slice.first_slot + k) * kLanes + lane;
      const Pack e = squared_stretch(step.nodes, layout.neighbours + slot, x,
                                     Set::load(layout.rest_lengths + slot));
      (k < slice.structural_slots ? structural : bending) =
          (k < slice.structural_slots ? structural : bending) + e;
    }
    if (layout.virtual_node_count > 0) {
      inner = squared_stretch(step.nodes, layout.inner_nodes + first, x,
                              Set::load(layout.inner_rest_lengths + first)) *
              Set::load(layout.inner_stiffnesses + first);
    }
    Set::store(twice + lane, structural * Set::broadcast(layout.structural_stiffness) +
                                 bending * Set::broadcast(layout.bending_stiffness) + inner +
                                 inner);
  }

  static double chunk_energy(const Layout& layout, const Step& step, std::size_t chunk) {
    double total = 0;
    float twice[kLanes];
    const auto [begin, end] = slices_of(layout, chunk);
    for (std::size_t index = begin; index < end; ++index) {
      for (std::size_t lane = 0; lane < kLanes; lane += kWidth) {
        add_energy(layout, step, index, lane, twice);
      }
      for (const float value : twice) total += static_cast<double>(value);
    }
    return total / 4;
  }
};

}  // namespace
}  // namespace palpate::deformation::kernel
