// What the assembly of both kinds of tetrahedra shares, for any instruction set: geometry in
// double, as many tetrahedra side by side as the set has lanes; blocks in float; then, one
// tetrahedron after the other, what it adds to the nodes and pairs of its part.
#pragma once

#include "deformation/elements/kernel/element_product_body.h"

namespace palpate::deformation::kernel {
namespace {

/// Corners a, b of an edge, and c, d so that ∂²v/∂x_a∂x_b = [x_c − x_d]×/6.
inline constexpr std::size_t kEdges[6][4] = {{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2},
                                             {1, 2, 0, 3}, {1, 3, 2, 0}, {2, 3, 0, 1}};

template <class Set>
inline Vector3<Set> scaled(const Vector3<Set>& a, const typename Set::Pack& s) {
  return {s * a.x, s * a.y, s * a.z};
}
template <class Set>
inline Vector3<Set> sum(const Vector3<Set>& a, const Vector3<Set>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class Set>
inline Vector3<Set> minus(const Vector3<Set>& a) {
  const typename Set::Pack zero = Set::broadcast(0);
  return {zero - a.x, zero - a.y, zero - a.z};
}
template <class Set>
inline Vector3<Set> cross(const Vector3<Set>& a, const Vector3<Set>& b) {
  return {Set::fnma(a.z, b.y, a.y * b.z), Set::fnma(a.x, b.z, a.z * b.x),
          Set::fnma(a.y, b.x, a.x * b.y)};
}

/// A 3×3 matrix by rows.
template <class Set>
struct Matrix3 {
  Vector3<Set> x, y, z;
};
template <class Set>
inline Vector3<Set> times(const Matrix3<Set>& m, const Vector3<Set>& v) {
  return {dot(m.x, v), dot(m.y, v), dot(m.z, v)};
}
/// m += a bᵀ
template <class Set>
inline void add_outer(Matrix3<Set>& m, const Vector3<Set>& a, const Vector3<Set>& b) {
  add_scaled(m.x, a.x, b);
  add_scaled(m.y, a.y, b);
  add_scaled(m.z, a.z, b);
}
template <class Set>
inline Matrix3<Set> outer(const Vector3<Set>& a, const Vector3<Set>& b) {
  return {scaled(b, a.x), scaled(b, a.y), scaled(b, a.z)};
}

/// Numbers of kTetrahedronLanes tetrahedra, lane by lane.
template <class Number>
struct Lanes {
  Number of[kTetrahedronLanes];
};
template <class Number>
struct LaneVectors {
  Lanes<Number> x, y, z;
};

/// What a batch of tetrahedra adds to nodes and pairs, until it is added. Quads of a pack stand
/// where Floats::transpose leaves them.
struct BatchSums {
  alignas(64) LaneVectors<double> forces[4];
  alignas(64) float edges[6][4][4 * kTetrahedronLanes];    ///< three rows, volume gradient
  alignas(64) float corners[4][3][4 * kTetrahedronLanes];  ///< rows of diagonal blocks

  static std::size_t quad_of(std::size_t lane) {
    return lane % 4 * kTetrahedronLanes + lane / 4 * 4;
  }
};

template <class Floats, class Doubles>
struct ElementAssembly {
  using Pack = typename Floats::Pack;
  using Vector = Vector3<Floats>;
  using Matrix = Matrix3<Floats>;
  using Wide = Vector3<Doubles>;
  static constexpr std::size_t kLanes = kTetrahedronLanes, kWidth = Floats::kWidth;

  static Vector load(const LaneVectors<float>& from, std::size_t lane) {
    return {Floats::load(from.x.of + lane), Floats::load(from.y.of + lane),
            Floats::load(from.z.of + lane)};
  }
  static void narrow(const Wide& from, std::size_t lane, LaneVectors<float>& to) {
    Doubles::narrow(to.x.of + lane, from.x);
    Doubles::narrow(to.y.of + lane, from.y);
    Doubles::narrow(to.z.of + lane, from.z);
  }
  static void store(const Wide& from, std::size_t lane, LaneVectors<double>& to) {
    Doubles::store(to.x.of + lane, from.x);
    Doubles::store(to.y.of + lane, from.y);
    Doubles::store(to.z.of + lane, from.z);
  }
  /// ∇N of corners 1 to 3 at rest.
  static void load_gradients(const double* batch, std::size_t lane, Wide (&g)[3]) {
    for (std::size_t k = 0; k < 3; ++k) {
      const double* const from = batch + 3 * k * kLanes + lane;
      g[k] = {Doubles::load(from), Doubles::load(from + kLanes), Doubles::load(from + 2 * kLanes)};
    }
  }
  /// Σ_a x_a g_aᵀ by edges from the first corner.
  static Matrix3<Doubles> deformation_gradient(const Wide (&edges)[3], const Wide (&g)[3]) {
    Matrix3<Doubles> F = outer(edges[0], g[0]);
    add_outer(F, edges[1], g[1]);
    add_outer(F, edges[2], g[2]);
    return F;
  }
  /// The forces on corners 1 to 3; the first gets minus their sum.
  static void store_forces(const Wide (&f)[3], std::size_t lane, BatchSums& sums) {
    for (std::size_t k = 0; k < 3; ++k) store(f[k], lane, sums.forces[k + 1]);
    store(minus(sum(f[0], sum(f[1], f[2]))), lane, sums.forces[0]);
  }

  /// Four numbers of kWidth tetrahedra as a quad each.
  static void store_quads(const Vector& v, const Pack& last, std::size_t lane, float* to) {
    const Vector4<Floats> quads = Floats::transpose(v.x, v.y, v.z, last);
    Floats::store(to + lane, quads.x);
    Floats::store(to + kLanes + lane, quads.y);
    Floats::store(to + 2 * kLanes + lane, quads.z);
    Floats::store(to + 3 * kLanes + lane, quads.w);
  }
  /// `last` in lane 3 of the rows.
  static void store_rows(const Matrix& m, const Vector& last, std::size_t lane,
                         float (*to)[4 * kLanes]) {
    store_quads(m.x, last.x, lane, to[0]);
    store_quads(m.y, last.y, lane, to[1]);
    store_quads(m.z, last.z, lane, to[2]);
  }

  /// Adds a batch's sums, of `count` tetrahedra.
  template <bool kVolume>
  static void add(const Tetrahedra& t, std::size_t batch, std::size_t count, const BatchSums& sums,
                  const ElementArrays& a) {
    for (std::size_t lane = 0; lane < count; ++lane) {
      const std::size_t quad = BatchSums::quad_of(lane);
      for (std::size_t e = 0; e < 6; ++e) {
        const std::size_t pair = t.pairs[(batch * 6 + e) * kLanes + lane];
        float* const block = a.blocks + block_place(pair);
        add_quad(block, load_quad(sums.edges[e][0] + quad));
        add_quad(block + kLanes, load_quad(sums.edges[e][1] + quad));
        add_quad(block + 2 * kLanes, load_quad(sums.edges[e][2] + quad));
        if constexpr (kVolume) {
          add_quad(a.volume_gradients + 4 * pair, load_quad(sums.edges[e][3] + quad));
        }
      }
      for (std::size_t k = 0; k < 4; ++k) {
        const std::size_t slot = t.corners[(batch * 4 + k) * kLanes + lane];
        for (std::size_t row = 0; row < 3; ++row) {
          add_quad(a.own_diagonals + 3 * slot + 4 * row, load_quad(sums.corners[k][row] + quad));
        }
        double* const force = a.forces + slot;
        force[0] += sums.forces[k].x.of[lane];
        force[1] += sums.forces[k].y.of[lane];
        force[2] += sums.forces[k].z.of[lane];
      }
    }
  }

  template <bool kVolume>
  static void clear(const ElementPart& part, const ElementArrays& a) {
    const std::size_t groups = part.group_count + part.spilt_groups;
    fill(a.blocks + kBlockFloats * part.first_group, kBlockFloats * groups);
    if constexpr (kVolume) fill(a.volume_gradients + kLanes * part.first_group, kLanes * groups);
    fill(a.own_diagonals + 12 * part.first_slot, 12 * part.slot_count);
    for (std::size_t i = 4 * part.first_slot; i < 4 * (part.first_slot + part.slot_count); ++i) {
      a.forces[i] = 0;
    }
  }
  static void fill(float* numbers, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) numbers[i] = 0;
  }

  /// How many tetrahedra of a batch are real, not there just to fill it up.
  static std::size_t count_in(const ElementPart& part, std::size_t batch) {
    const std::size_t left = part.tetrahedron_count - (batch - part.first_batch) * kLanes;
    return left < kLanes ? left : kLanes;
  }
};

}  // namespace
}  // namespace palpate::deformation::kernel
