// Quadratic tetrahedra for any instruction set (`Set`: quadratic_vectors.h), included once by each
// quadratic_<set>.cpp, which is compiled for that set.
//
// With M_j = ∂x/∂L_j at a point, C_j = ∂det M/∂M_j and det of the edges at rest 6 V:
//   J = det M/6V,   F Fᵀ = Σ M_i (∇L_i·∇L_j) M_jᵀ,   V/4 ∂J/∂M_j = C_j/24
#pragma once

#include "deformation/elements/quadratic_kernel/quadratic_gradients.h"

namespace palpate::deformation::kernel {
namespace {

/// Below this squared stretch, of tissue crushed to nothing, limits are not divided by it.
constexpr float kLeastSquaredStretch = 1e-3F;

template <class Set>
struct Quadratic {
  using Number = typename Set::Number;
  using Pack = typename Set::Pack;
  using Vector = Vectors<Set>;
  using Matrix = Derivatives<Set>;  ///< by columns

  static Matrix cofactor(const Matrix& m) {
    const auto& [a, b, c] = m.along;
    return {{cross(b, c), cross(c, a), cross(a, b)}};
  }
  static Pack inner(const Matrix& a, const Matrix& b) {
    return plus_dot(plus_dot(dot(a.along[0], b.along[0]), a.along[1], b.along[1]), a.along[2],
                    b.along[2]);
  }

  /// ∇L_i·∇L_j
  struct Metric {
    Pack g[6];

    /// `by` times it.
    Metric(const QuadraticBatch& batch, std::size_t lane, const Pack& by) {
      for (int k = 0; k < 6; ++k) g[k] = by * Set::load(batch.metric[k] + lane);
    }
    Metric(const QuadraticBatch& batch, std::size_t lane) : Metric(batch, lane, Pack{} + 1) {}
    /// Σ_i (∇L_i·∇L_j) m_i
    Matrix raise(const Matrix& m) const { return raise(m, {}); }
    /// sum + that
    Matrix raise(const Matrix& m, const Matrix& sum) const {
      const auto& [a, b, c] = m.along;
      const auto& [u, v, w] = sum.along;
      return {{plus(plus(plus(u, g[0], a), g[3], b), g[4], c),
               plus(plus(plus(v, g[3], a), g[1], b), g[5], c),
               plus(plus(plus(w, g[4], a), g[5], b), g[2], c)}};
    }
    /// ∇L_a·∇L_a of the corners.
    void of_corners(Pack (&own)[4]) const {
      own[0] = g[0] + g[1] + g[2] + 2 * (g[3] + g[4] + g[5]);
      for (int j = 0; j < 3; ++j) own[j + 1] = g[j];
    }
    /// ∇L_a·∇L_b of the edges' ends.
    void of_edges(Pack (&mixed)[6]) const {
      mixed[0] = -(g[0] + g[3] + g[4]);
      mixed[1] = g[3];
      mixed[2] = -(g[3] + g[1] + g[5]);
      mixed[3] = -(g[4] + g[5] + g[2]);
      mixed[4] = g[4];
      mixed[5] = g[5];
    }
  };

  static Matrix load_tangent(const QuadraticBatch& batch, std::size_t lane, int point) {
    Matrix m;
    for (int j = 0; j < 3; ++j) {
      const auto* axes = batch.tangents + 9 * point + 3 * j;
      m.along[j] =
          Vector{Set::load(axes[0] + lane), Set::load(axes[1] + lane), Set::load(axes[2] + lane)};
    }
    return m;
  }
  static void store_tangent(const Matrix& m, std::size_t lane, int point, QuadraticBatch& batch) {
    for (int j = 0; j < 3; ++j) {
      auto* axes = batch.tangents + 9 * point + 3 * j;
      Set::store(axes[0] + lane, m.along[j].x);
      Set::store(axes[1] + lane, m.along[j].y);
      Set::store(axes[2] + lane, m.along[j].z);
    }
  }

  /// Four lanes after four, so that all instruction sets add to a node in the same order.
  static void scatter_all(float* base, const QuadraticBatch& batch, std::size_t lane,
                          const Vector (&vectors)[10], const Pack (&fourths)[10]) {
    const Addends<Set> addends[10] = {{vectors[0], fourths[0]}, {vectors[1], fourths[1]},
                                      {vectors[2], fourths[2]}, {vectors[3], fourths[3]},
                                      {vectors[4], fourths[4]}, {vectors[5], fourths[5]},
                                      {vectors[6], fourths[6]}, {vectors[7], fourths[7]},
                                      {vectors[8], fourths[8]}, {vectors[9], fourths[9]}};
    for (std::size_t k = 0; k < Set::kWidth / 4; ++k) {
      for (int a = 0; a < 10; ++a) addends[a].add(k, base, batch.nodes[a] + lane);
    }
  }
  static constexpr Pack kNone[10] = {};

  /// Seen from the first corner, for float's sake.
  static void load_positions(const QuadraticPass& pass, const QuadraticBatch& batch,
                             std::size_t lane, Vector (&x)[10]) {
    x[0] = Vector{};
    for (int a = 1; a < 10; ++a) {
      Number apart[3][Set::kWidth];
      for (std::size_t l = 0; l < Set::kWidth; ++l) {
        const double* const from = pass.positions + 3 * std::size_t{batch.nodes[0][lane + l]};
        const double* const to = pass.positions + 3 * std::size_t{batch.nodes[a][lane + l]};
        for (int axis = 0; axis < 3; ++axis) {
          apart[axis][l] = static_cast<Number>(to[axis] - from[axis]);
        }
      }
      __builtin_memcpy(&x[a].x, apart[0], sizeof(Pack));
      __builtin_memcpy(&x[a].y, apart[1], sizeof(Pack));
      __builtin_memcpy(&x[a].z, apart[2], sizeof(Pack));
    }
  }

  /// Bound of the squared largest singular value, exact where the other two are equal:
  /// H. Wolkowicz, G. Styan, Linear Algebra Appl. 29, 1980.
  /// @param raised  of m by the metric
  static Pack squared_stretch(const Matrix& m, const Matrix& raised) {
    const auto& [a, b, c] = m.along;
    const auto& [p, q, r] = raised.along;
    const Pack xx = a.x * p.x + b.x * q.x + c.x * r.x, xy = a.x * p.y + b.x * q.y + c.x * r.y;
    const Pack yy = a.y * p.y + b.y * q.y + c.y * r.y, xz = a.x * p.z + b.x * q.z + c.x * r.z;
    const Pack zz = a.z * p.z + b.z * q.z + c.z * r.z, yz = a.y * p.z + b.y * q.z + c.y * r.z;
    const Pack mean = (xx + yy + zz) / 3;
    const Pack squares = (xx * xx + yy * yy + zz * zz) + 2 * (xy * xy + xz * xz + yz * yz);
    const Pack spread = larger<Set>(squares / 3 - mean * mean, Pack{});
    return larger<Set>(mean + Set::root(2 * spread), Pack{} + kLeastSquaredStretch);
  }

  /// c' of c, as AverageNodalPressure::kept_turning().
  static Pack kept_turning(const QuadraticPass& pass, const Pack& c, const Pack& squared_stretch,
                           const Pack& stretch, const Pack& J) {
    const auto mu = static_cast<float>(pass.shear_modulus);
    const Pack of_stretches =
        larger<Set>(J, Pack{}) * (1.5F * static_cast<float>(pass.point_modulus) +
                                  0.5F * mu / (squared_stretch * squared_stretch));
    return smaller<Set>(larger<Set>(c, -smaller<Set>(mu / stretch, of_stretches)), Pack{});
  }

  /// Of what positions are at the points, 4 ε.
  static Pack grown(const Pack (&J)[4]) {
    return ((J[0] - 1) + (J[1] - 1)) + ((J[2] - 1) + (J[3] - 1));
  }

  static void press(const QuadraticPass& pass, QuadraticBatch& batch, std::size_t lane) {
    const Pack per_volume = Set::load(batch.per_volume[0] + lane);
    Vector nodes[10];
    Matrix at[4];
    Pack J[4];
    load_positions(pass, batch, lane, nodes);
    differentiate(nodes, at);
    for (int q = 0; q < 4; ++q) {
      const auto& [a, b, c] = at[q].along;
      J[q] = per_volume / 6 * dot(cross(b, c), a);
    }
    float* const pressures = batch.pressure[0] + lane;
    Set::store(pressures, static_cast<float>(pass.bulk_modulus) / 4 * grown(J));
  }

  /// U of each.
  static void measure(const QuadraticPass& pass, QuadraticBatch& batch, std::size_t lane) {
    const Pack volume = Set::load(batch.volume[0] + lane);
    const Metric metric(batch, lane);
    Vector nodes[10];
    Matrix at[4];
    Pack growth = {}, sum = {};
    load_positions(pass, batch, lane, nodes);
    differentiate(nodes, at);
    for (const Matrix& m : at) {
      const Pack change = dot(cross(m.along[1], m.along[2]), m.along[0]) / (6 * volume) - 1;
      sum = sum + pass.shear_modulus / 2 * (inner(m, metric.raise(m)) - 3) -
            pass.shear_modulus * change + pass.point_modulus / 2 * change * change;
      growth = growth + change / 4;
    }
    const Pack energies = volume * (sum / 4 + pass.bulk_modulus / 2 * growth * growth);
    double* const first = pass.energies + kQuadraticLanes * (&batch - pass.batches) + lane;
    __builtin_memcpy(first, &energies, sizeof(Pack));
  }

  static void linearise(const QuadraticPass& pass, QuadraticBatch& batch, std::size_t lane) {
    const auto mu = static_cast<float>(pass.shear_modulus);
    const auto alpha = static_cast<float>(pass.point_modulus);
    const auto kappa = static_cast<float>(pass.bulk_modulus);
    const Pack volume = Set::load(batch.volume[0] + lane);
    const Pack per_volume = Set::load(batch.per_volume[0] + lane);
    const Metric metric(batch, lane);
    Vector nodes[10];
    Matrix at[4], areas[4];
    Pack J[4], shapes[4];
    load_positions(pass, batch, lane, nodes);
    differentiate(nodes, at);
    for (int q = 0; q < 4; ++q) {
      store_tangent(at[q], lane, q, batch);
      areas[q] = cofactor(at[q]);
      J[q] = per_volume / 6 * dot(areas[q].along[0], at[q].along[0]);
    }
    const Pack growth = grown(J);
    const Pack pressure =
        Set::load(batch.pressure[0] + lane) + kappa / 4 * Set::load(batch.share[0] + lane) * growth;
    for (int q = 0; q < 4; ++q) {
      const Matrix raised = metric.raise(at[q]);
      const Pack squared = squared_stretch(at[q], raised), stretch = Set::root(squared);
      const Pack c = alpha * (J[q] - 1) - mu + pressure;
      const Pack kept = kept_turning(pass, c, squared, stretch, J[q]);
      shapes[q] = pass.scale / 4 * volume * (mu + 2 * stretch * larger<Set>(c - kept, kept - c));
      Set::store(batch.shapes[q] + lane, shapes[q]);
      Set::store(batch.turnings[q] + lane, pass.scale / 24 * kept);
      for (int j = 0; j < 3; ++j) {
        at[q].along[j] =
            plus(scaled(-mu / 4 * volume, raised.along[j]), -c / 24, areas[q].along[j]);
      }
    }
    integrate(at, nodes);
    scatter_all(pass.forces, batch, lane, nodes, kNone);
    add_diagonals(pass, batch, lane, areas, shapes);
  }

  static void add_diagonals(const QuadraticPass& pass, const QuadraticBatch& batch,
                            std::size_t lane, const Matrix (&areas)[4], const Pack (&shapes)[4]) {
    const Pack per_volume = Set::load(batch.per_volume[0] + lane);
    const Pack share = Set::load(batch.share[0] + lane);
    Pack own[4], mixed[6];
    Metric(batch, lane).of_corners(own);
    Metric(batch, lane).of_edges(mixed);
    Vector faces[4][4];  // C ∂L_a, of the corners
    for (int q = 0; q < 4; ++q) {
      for (int j = 0; j < 3; ++j) faces[q][j + 1] = areas[q].along[j];
      faces[q][0] = -1.0F * (faces[q][1] + faces[q][2] + faces[q][3]);
    }
    Vector squares[10], others[10];
    Pack mixed_xy[10];
    for (int a = 0; a < 10; ++a) {
      Pack weight = {};
      Vector rows[4];
      for (int q = 0; q < 4; ++q) {
        if (a < 4) {
          const auto f = static_cast<float>(4 * (a == q ? kNearCorner : kFarCorner) - 1);
          weight = weight + f * f * shapes[q] * own[a];
          rows[q] = f * faces[q][a];
        } else {
          const auto [i, j] = kEdgeEnds[a - 4];
          const auto fi = static_cast<float>(4 * (i == q ? kNearCorner : kFarCorner));
          const auto fj = static_cast<float>(4 * (j == q ? kNearCorner : kFarCorner));
          weight = weight +
                   shapes[q] * (fi * fi * own[j] + 2 * fi * fj * mixed[a - 4] + fj * fj * own[i]);
          rows[q] = fi * faces[q][j] + fj * faces[q][i];
        }
      }
      const Outer block = squared(pass, per_volume, share, rows);
      squares[a] = block.squares + Vector{weight, weight, weight};
      mixed_xy[a] = block.mixed.x;
      others[a] = Vector{block.mixed.y, block.mixed.z, Pack{}};
    }
    scatter_all(pass.diagonal, batch, lane, squares, mixed_xy);
    scatter_all(pass.mixed_z, batch, lane, others, kNone);
  }

  /// xx, yy, zz and xy, xz, yz.
  struct Outer {
    Vector squares, mixed;
  };
  /// What volumes add to a node's block.
  /// @param rows  24 V/4 ∂J/∂x of the node at the points
  static Outer squared(const QuadraticPass& pass, const Pack& per_volume, const Pack& share,
                       const Vector (&rows)[4]) {
    const Pack of_points = pass.scale * static_cast<float>(pass.point_modulus) / 144 * per_volume;
    const Pack of_all =
        pass.scale * static_cast<float>(pass.bulk_modulus) / 576 * share * per_volume;
    const Vector all = (rows[0] + rows[1]) + (rows[2] + rows[3]);
    const Vector scaled_all = scaled(of_all, all);
    Vector squares = {scaled_all.x * all.x, scaled_all.y * all.y, scaled_all.z * all.z};
    Vector mixed = {scaled_all.x * all.y, scaled_all.x * all.z, scaled_all.y * all.z};
    for (const Vector& row : rows) {
      const Vector own = scaled(of_points, row);
      squares = squares + Vector{own.x * row.x, own.y * row.y, own.z * row.z};
      mixed = mixed + Vector{own.x * row.y, own.x * row.z, own.y * row.z};
    }
    return {squares, mixed};
  }

  static void multiply(const QuadraticPass& pass, const QuadraticBatch& batch, std::size_t lane) {
    const Pack per_volume = Set::load(batch.per_volume[0] + lane);
    Vector nodes[10];
    Matrix at[4];
    Pack rates[4];  // of 6 V J
    for (int a = 0; a < 10; ++a) nodes[a] = gather<Set>(pass.vector, batch.nodes[a] + lane);
    differentiate(nodes, at);
    Matrix areas[4];
    for (int q = 0; q < 4; ++q) {
      areas[q] = cofactor(load_tangent(batch, lane, q));
      rates[q] = inner(areas[q], at[q]);
    }
    const Pack of_points = pass.scale * static_cast<float>(pass.point_modulus) / 144 * per_volume;
    const Pack of_all = pass.scale * static_cast<float>(pass.bulk_modulus) / 576 *
                        Set::load(batch.share[0] + lane) * per_volume *
                        ((rates[0] + rates[1]) + (rates[2] + rates[3]));
    for (int q = 0; q < 4; ++q) {
      const Pack turning = Set::load(batch.turnings[q] + lane);
      const Pack push = Set::fma(of_points, rates[q], of_all);
      const auto& [a, b, c] = load_tangent(batch, lane, q).along;
      const auto& [u, v, w] = at[q].along;
      const Vector tu = scaled(turning, u), tv = scaled(turning, v), tw = scaled(turning, w);
      const auto& [p, r, s] = areas[q].along;
      const Matrix of_volume = {{plus_cross(plus_cross(scaled(push, p), b, tw), tv, c),
                                 plus_cross(plus_cross(scaled(push, r), c, tu), tw, a),
                                 plus_cross(plus_cross(scaled(push, s), a, tv), tu, b)}};
      at[q] = Metric(batch, lane, Set::load(batch.shapes[q] + lane)).raise(at[q], of_volume);
    }
    integrate(at, nodes);
    scatter_all(pass.product, batch, lane, nodes, kNone);
  }

  template <auto visit>
  static void run(const QuadraticPass& pass) {
    for (std::size_t b = 0; b < pass.batch_count; ++b) {
      for (std::size_t lane = 0; lane < kQuadraticLanes; lane += Set::kWidth) {
        visit(pass, pass.batches[b], lane);
      }
    }
  }

  static QuadraticKernel kernel() {
    return {&run<&press>, &run<&linearise>, &run<&multiply>,
            &Quadratic<typename Set::Doubles>::template run<
                &Quadratic<typename Set::Doubles>::measure>};
  }
};

}  // namespace
}  // namespace palpate::deformation::kernel
