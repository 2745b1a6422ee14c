// Tetrahedra of average_nodal_pressure.h, for any instruction set. Its formulas, in its words:
// areas b_a = ∂v/∂x_a, pull c = ∂ψ/∂J + mean pressure, kept c', stretch σ.
#pragma once

#include "deformation/elements/kernel/element_assembly_body.h"

namespace palpate::deformation::kernel {
namespace {

template <class Floats, class Doubles>
struct PressureAssembly : ElementAssembly<Floats, Doubles> {
  using Base = ElementAssembly<Floats, Doubles>;
  using Base::kLanes;
  using typename Base::Matrix;
  using typename Base::Pack;
  using typename Base::Vector;
  using typename Base::Wide;
  using WidePack = typename Doubles::Pack;

  /// Of a batch, in float.
  struct Batch {
    alignas(64) LaneVectors<float> edges[3], areas[3], gradients[3];
    Lanes<float> pull, ratio, rest_volume;
  };

  static void load_edges(const Tetrahedra& t, const ElementArrays& a, std::size_t batch,
                         std::size_t lane, Wide (&edges)[3], WidePack& pressures) {
    const std::uint32_t* const corners = t.corners + batch * 4 * kLanes + lane;
    const Vector4<Doubles> origin = Doubles::load_quads(a.positions, corners);
    pressures = origin.w;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto x = Doubles::load_quads(a.positions, corners + (k + 1) * kLanes);
      edges[k] = {x.x - origin.x, x.y - origin.y, x.z - origin.z};
      pressures = pressures + x.w;
    }
  }

  static void take_volumes(const ElementPart& part, const Tetrahedra& t, const ElementArrays& a) {
    for (std::size_t i = part.first_slot; i < part.first_slot + part.slot_count; ++i) {
      a.node_volumes[i] = 0;
    }
    for (std::size_t n = part.first_batch; n < part.first_batch + part.batch_count; ++n) {
      for (std::size_t lane = 0; lane < kLanes; lane += Doubles::kWidth) {
        Wide edges[3];
        WidePack unused;
        load_edges(t, a, n, lane, edges, unused);
        const WidePack volume =
            dot(cross(edges[0], edges[1]), edges[2]) * Doubles::broadcast(1.0 / 6);
        Doubles::store(a.volumes + n * kLanes + lane, volume);
      }
      const std::size_t count = Base::count_in(part, n);
      for (std::size_t lane = 0; lane < count; ++lane) {
        for (std::size_t k = 0; k < 4; ++k) {
          a.node_volumes[t.corners[(n * 4 + k) * kLanes + lane] / 4] +=
              a.volumes[n * kLanes + lane];
        }
      }
    }
  }

  /// −μ V F g_a − c b_a, and what the blocks are made of.
  static void take_forces(const Tetrahedra& t, const ElementArrays& a, const PressureTerms& terms,
                          std::size_t n, std::size_t lane, Batch& batch, BatchSums& sums) {
    Wide edges[3], areas[3], g[3], f[3];
    WidePack pressures;
    load_edges(t, a, n, lane, edges, pressures);
    Base::load_gradients(t.gradients + n * 9 * kLanes, lane, g);
    const WidePack sixth = Doubles::broadcast(1.0 / 6);
    areas[0] = scaled(cross(edges[1], edges[2]), sixth);
    areas[1] = scaled(cross(edges[2], edges[0]), sixth);
    areas[2] = scaled(cross(edges[0], edges[1]), sixth);
    const WidePack mu = Doubles::broadcast(terms.shear_modulus);
    const WidePack rest = Doubles::load(t.volumes + n * kLanes + lane);
    const WidePack J = Doubles::load(a.volumes + n * kLanes + lane) / rest;
    WidePack pull = Doubles::fma(pressures, Doubles::broadcast(0.25), Doubles::broadcast(0) - mu);
    pull = Doubles::fma(Doubles::broadcast(terms.volume_modulus), J - Doubles::broadcast(1), pull);
    const Matrix3<Doubles> F = Base::deformation_gradient(edges, g);
    const WidePack shape = Doubles::broadcast(0) - mu * rest;
    for (std::size_t k = 0; k < 3; ++k) {
      f[k] = scaled(times(F, g[k]), shape);
      add_scaled(f[k], Doubles::broadcast(0) - pull, areas[k]);
      Base::narrow(edges[k], lane, batch.edges[k]);
      Base::narrow(areas[k], lane, batch.areas[k]);
      Base::narrow(g[k], lane, batch.gradients[k]);
    }
    Base::store_forces(f, lane, sums);
    Doubles::narrow(batch.pull.of + lane, pull);
    Doubles::narrow(batch.ratio.of + lane, J);
    Doubles::narrow(batch.rest_volume.of + lane, rest);
  }

  static Pack least(const Pack& a, const Pack& b) { return Floats::larger(a, b, b, a); }

  /// σ: mean + deviation of FᵀF, the latter without the difference of two squares.
  static Pack largest_stretch(const Vector (&edges)[3], const Vector (&g)[3]) {
    Matrix F = outer(edges[0], g[0]);
    add_outer(F, edges[1], g[1]);
    add_outer(F, edges[2], g[2]);
    const auto inner = [&](const Pack& x, const Pack& y, const Pack& z, const Pack& u,
                           const Pack& v,
                           const Pack& w) { return Floats::fma(x, u, Floats::fma(y, v, z * w)); };
    const Pack xx = inner(F.x.x, F.y.x, F.z.x, F.x.x, F.y.x, F.z.x);
    const Pack yy = inner(F.x.y, F.y.y, F.z.y, F.x.y, F.y.y, F.z.y);
    const Pack zz = inner(F.x.z, F.y.z, F.z.z, F.x.z, F.y.z, F.z.z);
    const Pack xy = inner(F.x.x, F.y.x, F.z.x, F.x.y, F.y.y, F.z.y);
    const Pack yz = inner(F.x.y, F.y.y, F.z.y, F.x.z, F.y.z, F.z.z);
    const Pack zx = inner(F.x.z, F.y.z, F.z.z, F.x.x, F.y.x, F.z.x);
    const Pack mean = (xx + yy + zz) * Floats::broadcast(1.0f / 3);
    const Vector off{xx - mean, yy - mean, zz - mean}, mixed{xy, yz, zx};
    const Pack squares = Floats::fma(Floats::broadcast(2), dot(mixed, mixed), dot(off, off));
    return Floats::root(mean + Floats::root(Floats::broadcast(2.0f / 3) * squares));
  }

  struct Turning {
    Pack kept, made_up;  ///< c', 2σ|c − c'|
  };
  static Turning turning_of(const Batch& batch, std::size_t lane, const PressureTerms& terms,
                            const Pack& stretch) {
    const auto mu = static_cast<float>(terms.shear_modulus);
    const Pack zero = Floats::broadcast(0), J = Floats::load(batch.ratio.of + lane);
    const Pack over_stretch = Floats::broadcast(mu) / stretch;
    const Pack square = stretch * stretch;
    const Pack bulk = Floats::broadcast(static_cast<float>(3 * terms.volume_modulus)) +
                      Floats::broadcast(mu) / (square * square);
    const Pack for_stretches = Floats::larger(J, zero, J, zero) * bulk * Floats::broadcast(0.5f);
    const Pack limit = least(over_stretch, for_stretches);
    const Pack pull = Floats::load(batch.pull.of + lane);
    const Pack above = zero - limit;
    const Pack kept = least(Floats::larger(pull, above, pull, above), zero);
    return {kept, Floats::broadcast(2) * stretch * Floats::absolute(pull - kept)};
  }

  /// α/V b bᵀ + c' ∂²v/∂x² + (μ V + θ V) (g_a·g_b) I, scaled.
  static void take_blocks(const Tetrahedra& t, const PressureTerms& terms, std::size_t n,
                          std::size_t lane, const Batch& batch, BatchSums& sums) {
    Vector edges[3], areas[4], g[4];
    for (std::size_t k = 0; k < 3; ++k) {
      edges[k] = Base::load(batch.edges[k], lane);
      areas[k + 1] = Base::load(batch.areas[k], lane);
      g[k + 1] = Base::load(batch.gradients[k], lane);
    }
    const Turning turning =
        turning_of(batch, lane, terms, largest_stretch(edges, {g[1], g[2], g[3]}));
    areas[0] = minus(sum(areas[1], sum(areas[2], areas[3])));
    g[0] = minus(sum(g[1], sum(g[2], g[3])));
    const Pack rest = Floats::load(batch.rest_volume.of + lane);
    const Pack own =
        Floats::broadcast(static_cast<float>(terms.scale * terms.volume_modulus)) / rest;
    const auto mu = static_cast<float>(terms.shear_modulus);
    const Pack scale = Floats::broadcast(static_cast<float>(terms.scale));
    const Pack shape = scale * rest * (Floats::broadcast(mu) + turning.made_up);
    for (std::size_t k = 0; k < 4; ++k) {
      Matrix block = outer(scaled(areas[k], own), areas[k]);
      add_to_diagonal(block, shape * dot(g[k], g[k]));
      Base::store_rows(block, areas[k], lane, sums.corners[k]);
    }
    const Vector zero{Floats::broadcast(0), Floats::broadcast(0), Floats::broadcast(0)};
    const Vector x[4] = {zero, edges[0], edges[1], edges[2]};
    const Pack turn = scale * turning.kept * Floats::broadcast(1.0f / 6);
    for (std::size_t e = 0; e < 6; ++e) {
      const auto& [a, b, c, d] = kEdges[e];
      const Pack flip = Floats::load(t.flips + (n * 6 + e) * kLanes + lane), none = zero.x;
      const Vector row = chosen(flip, none, areas[b], areas[a]);
      const Vector column = chosen(flip, none, areas[a], areas[b]);
      Matrix block = outer(scaled(row, own), column);
      const Vector axis = scaled(x[c] - x[d], Floats::larger(flip, none, none - turn, turn));
      add_skew(block, axis);
      add_to_diagonal(block, shape * dot(g[a], g[b]));
      Base::store_rows(block, row, lane, sums.edges[e]);
      Base::store_quads(column, none, lane, sums.edges[e][3]);
    }
  }

  static Vector chosen(const Pack& flip, const Pack& none, const Vector& yes, const Vector& no) {
    return {Floats::larger(flip, none, yes.x, no.x), Floats::larger(flip, none, yes.y, no.y),
            Floats::larger(flip, none, yes.z, no.z)};
  }
  static void add_to_diagonal(Matrix& m, const Pack& s) {
    m.x.x = m.x.x + s;
    m.y.y = m.y.y + s;
    m.z.z = m.z.z + s;
  }
  /// m += [e]×
  static void add_skew(Matrix& m, const Vector& e) {
    m.x.y = m.x.y - e.z;
    m.x.z = m.x.z + e.y;
    m.y.x = m.y.x + e.z;
    m.y.z = m.y.z - e.x;
    m.z.x = m.z.x - e.y;
    m.z.y = m.z.y + e.x;
  }

  /// Numbers of a batch's tetrahedra, in their order.
  static double total(const Lanes<double>& numbers, std::size_t count) {
    double sum = 0;
    for (std::size_t lane = 0; lane < count; ++lane) sum += numbers.of[lane];
    return sum;
  }

  /// V (μ/2 (tr FᵀF − 3) − μ (J − 1) + α/2 (J − 1)²)
  static double energy(const ElementPart& part, const Tetrahedra& t, const ElementArrays& a,
                       const PressureTerms& terms) {
    const auto number = [](double x) { return Doubles::broadcast(x); };
    double all = 0;
    for (std::size_t n = part.first_batch; n < part.first_batch + part.batch_count; ++n) {
      Lanes<double> energies{};
      for (std::size_t lane = 0; lane < kLanes; lane += Doubles::kWidth) {
        Wide edges[3], g[3];
        WidePack unused;
        load_edges(t, a, n, lane, edges, unused);
        Base::load_gradients(t.gradients + n * 9 * kLanes, lane, g);
        const Matrix3<Doubles> F = Base::deformation_gradient(edges, g);
        const WidePack squared = dot(F.x, F.x) + dot(F.y, F.y) + dot(F.z, F.z);
        const WidePack rest = Doubles::load(t.volumes + n * kLanes + lane);
        const WidePack change = Doubles::load(a.volumes + n * kLanes + lane) / rest - number(1);
        const WidePack stretched =
            number(terms.shear_modulus) * (number(0.5) * (squared - number(3)) - change);
        const WidePack squeezed = number(terms.volume_modulus / 2) * (change * change);
        Doubles::store(energies.of + lane, rest * (stretched + squeezed));
      }
      all += total(energies, Base::count_in(part, n));
    }
    return all;
  }

  static void assemble(const ElementPart& part, const Tetrahedra& t, const ElementArrays& a,
                       const PressureTerms& terms) {
    Base::template clear<true>(part, a);
    for (std::size_t n = part.first_batch; n < part.first_batch + part.batch_count; ++n) {
      Batch batch;
      BatchSums sums;
      for (std::size_t lane = 0; lane < kLanes; lane += Doubles::kWidth) {
        take_forces(t, a, terms, n, lane, batch, sums);
      }
      for (std::size_t lane = 0; lane < kLanes; lane += Floats::kWidth) {
        take_blocks(t, terms, n, lane, batch, sums);
      }
      Base::template add<true>(t, n, Base::count_in(part, n), sums, a);
    }
  }
};

}  // namespace
}  // namespace palpate::deformation::kernel
