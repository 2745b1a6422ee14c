// Tetrahedra of corotational.h, for any instruction set, and the nearest rotation of
// modules/core/polar_decomposition.h side by side.
#pragma once

#include "deformation/elements/kernel/element_pressure_body.h"

namespace palpate::deformation::kernel {
namespace {

/// Of N, symmetric, its 2×2 minors of rows 0, 1 and of rows 2, 3.
template <class Doubles>
struct Minors {
  using Pack = typename Doubles::Pack;
  Pack s[6], c[6];

  static Pack minor_of(const Pack& a, const Pack& d, const Pack& b, const Pack& c) {
    return Doubles::fnma(b, c, a * d);
  }
  explicit Minors(const Pack (&m)[4][4]) {
    constexpr std::size_t kColumns[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
    for (std::size_t k = 0; k < 6; ++k) {
      const auto [i, j] = kColumns[k];
      s[k] = minor_of(m[0][i], m[1][j], m[1][i], m[0][j]);
      c[k] = minor_of(m[2][i], m[3][j], m[3][i], m[2][j]);
    }
  }
  Pack determinant() const {
    return (s[0] * c[5] - s[1] * c[4]) + (s[2] * c[3] + s[3] * c[2]) - (s[4] * c[1] - s[5] * c[0]);
  }
};

template <class Doubles>
struct NearestRotation {
  using Pack = typename Doubles::Pack;
  using Matrix = Matrix3<Doubles>;
  static constexpr int kMostNewton = 30;

  static Pack number(double x) { return Doubles::broadcast(x); }
  static Pack absolute(const Pack& x) {
    const Pack zero = number(0);
    return Doubles::larger(x, zero, x, zero - x);
  }

  /// Horn's matrix of F.
  static void take_horn_matrix(const Matrix& F, Pack (&N)[4][4]) {
    N[0][0] = F.x.x + F.y.y + F.z.z;
    N[0][1] = N[1][0] = F.z.y - F.y.z;
    N[0][2] = N[2][0] = F.x.z - F.z.x;
    N[0][3] = N[3][0] = F.y.x - F.x.y;
    N[1][1] = F.x.x - F.y.y - F.z.z;
    N[2][2] = F.y.y - F.x.x - F.z.z;
    N[3][3] = F.z.z - F.x.x - F.y.y;
    N[1][2] = N[2][1] = F.x.y + F.y.x;
    N[1][3] = N[3][1] = F.x.z + F.z.x;
    N[2][3] = N[3][2] = F.y.z + F.z.y;
  }

  /// Newton from above; a lane that has come to rest stays where it is.
  static Pack largest_eigenvalue(const Matrix& F, const Pack (&N)[4][4]) {
    const Pack zero = number(0), squared = dot(F.x, F.x) + dot(F.y, F.y) + dot(F.z, F.z);
    const Pack c2 = number(-2) * squared, c0 = Minors<Doubles>(N).determinant();
    const Pack c1 = number(-8) * dot(cross(F.x, F.y), F.z);
    Pack root = Doubles::root(number(3) * squared), moving = number(1);
    for (int k = 0; k < kMostNewton && Doubles::any_larger(moving, zero); ++k) {
      const Pack square = root * root;
      const Pack value = Doubles::fma(Doubles::fma(square + c2, root, c1), root, c0);
      const Pack slope = Doubles::fma(Doubles::fma(number(4), square, c2 + c2), root, c1);
      moving = Doubles::larger(slope, zero, moving, zero);
      const Pack change = Doubles::larger(moving, zero, value / slope, zero);
      root = root - change;
      moving = Doubles::larger(absolute(change), number(1e-13) * root, moving, zero);
    }
    return root;
  }

  /// A column of the adjugate of N − λ, the one with the largest diagonal; (1, 0, 0, 0) if none is.
  static void take_null_vector(Pack (&m)[4][4], const Pack& root, Pack (&q)[4]) {
    for (std::size_t k = 0; k < 4; ++k) m[k][k] = m[k][k] - root;
    const Minors<Doubles> minors(m);
    const Pack(&s)[6] = minors.s, (&c)[6] = minors.c;
    const auto three = [](const Pack& a, const Pack& b, const Pack& u, const Pack& v, const Pack& x,
                          const Pack& y) { return a * b - u * v + x * y; };
    const Pack zero = number(0);
    const Pack a00 = three(m[1][1], c[5], m[1][2], c[4], m[1][3], c[3]);
    const Pack a01 = zero - three(m[0][1], c[5], m[0][2], c[4], m[0][3], c[3]);
    const Pack a02 = three(m[3][1], s[5], m[3][2], s[4], m[3][3], s[3]);
    const Pack a03 = zero - three(m[2][1], s[5], m[2][2], s[4], m[2][3], s[3]);
    const Pack a11 = three(m[0][0], c[5], m[0][2], c[2], m[0][3], c[1]);
    const Pack a12 = zero - three(m[3][0], s[5], m[3][2], s[2], m[3][3], s[1]);
    const Pack a13 = three(m[2][0], s[5], m[2][2], s[2], m[2][3], s[1]);
    const Pack a22 = three(m[3][0], s[4], m[3][1], s[2], m[3][3], s[0]);
    const Pack a23 = zero - three(m[2][0], s[4], m[2][1], s[2], m[2][3], s[0]);
    const Pack a33 = three(m[2][0], s[3], m[2][1], s[1], m[2][2], s[0]);
    const Pack columns[4][4] = {
        {a00, a01, a02, a03}, {a01, a11, a12, a13}, {a02, a12, a22, a23}, {a03, a13, a23, a33}};
    Pack most = number(1e-12) * root * root * root;
    q[0] = number(1);
    q[1] = q[2] = q[3] = zero;
    for (std::size_t k = 0; k < 4; ++k) {
      const Pack size = absolute(columns[k][k]);
      for (std::size_t i = 0; i < 4; ++i) {
        q[i] = Doubles::larger(size, most, columns[k][i], q[i]);
      }
      most = Doubles::larger(size, most, size, most);
    }
  }

  static Matrix of(const Matrix& F) {
    Pack N[4][4], q[4];
    take_horn_matrix(F, N);
    take_null_vector(N, largest_eigenvalue(F, N), q);
    const Pack squared = (q[0] * q[0] + q[1] * q[1]) + (q[2] * q[2] + q[3] * q[3]);
    const Pack two = number(2) / squared, one = number(1);
    const auto twice = [&](const Pack& a, const Pack& b) { return two * (a * b); };
    const Pack xx = twice(q[1], q[1]), yy = twice(q[2], q[2]), zz = twice(q[3], q[3]);
    const Pack xy = twice(q[1], q[2]), yz = twice(q[2], q[3]), zx = twice(q[3], q[1]);
    const Pack wx = twice(q[0], q[1]), wy = twice(q[0], q[2]), wz = twice(q[0], q[3]);
    return {{one - yy - zz, xy - wz, zx + wy},
            {xy + wz, one - xx - zz, yz - wx},
            {zx - wy, yz + wx, one - xx - yy}};
  }
};

template <class Floats, class Doubles>
struct CorotationalAssembly : PressureAssembly<Floats, Doubles> {
  using Base = PressureAssembly<Floats, Doubles>;
  using Base::kLanes;
  using typename Base::Matrix;
  using typename Base::Pack;
  using typename Base::Vector;
  using typename Base::Wide;
  using WidePack = typename Doubles::Pack;

  /// R g of corners 1 to 3, and V.
  struct Turned {
    alignas(64) LaneVectors<float> gradients[3];
    Lanes<float> rest_volume;
  };

  /// −V P g_a,  P = 2μ F + (λ (R:F − 3) − 2μ) R
  static void take_turned_forces(const Tetrahedra& t, const ElementArrays& a,
                                 const CorotationalTerms& terms, std::size_t n, std::size_t lane,
                                 Turned& turned, BatchSums& sums) {
    Wide edges[3], g[3], f[3];
    WidePack unused;
    Base::load_edges(t, a, n, lane, edges, unused);
    Base::load_gradients(t.gradients + n * 9 * kLanes, lane, g);
    const Matrix3<Doubles> F = Base::deformation_gradient(edges, g);
    const Matrix3<Doubles> R = NearestRotation<Doubles>::of(F);
    const WidePack trace = dot(R.x, F.x) + dot(R.y, F.y) + dot(R.z, F.z);
    const WidePack along = Doubles::broadcast(terms.lambda) * (trace - Doubles::broadcast(3)) -
                           Doubles::broadcast(2 * terms.shear_modulus);
    const WidePack rest = Doubles::load(t.volumes + n * kLanes + lane);
    const WidePack twice = Doubles::broadcast(-2 * terms.shear_modulus) * rest;
    const WidePack turn = Doubles::broadcast(0) - along * rest;
    for (std::size_t k = 0; k < 3; ++k) {
      const Wide Rg = times(R, g[k]);
      f[k] = scaled(times(F, g[k]), twice);
      add_scaled(f[k], turn, Rg);
      Base::narrow(Rg, lane, turned.gradients[k]);
    }
    Base::store_forces(f, lane, sums);
    Doubles::narrow(turned.rest_volume.of + lane, rest);
  }

  /// V (λ g_a g_bᵀ + μ g_b g_aᵀ + μ g_a·g_b I), scaled.
  static void take_turned_blocks(const Tetrahedra& t, const CorotationalTerms& terms, std::size_t n,
                                 std::size_t lane, const Turned& turned, BatchSums& sums) {
    Vector g[4];
    for (std::size_t k = 0; k < 3; ++k) g[k + 1] = Base::load(turned.gradients[k], lane);
    g[0] = minus(sum(g[1], sum(g[2], g[3])));
    const Pack rest = Floats::load(turned.rest_volume.of + lane), none = Floats::broadcast(0);
    const Pack mu = Floats::broadcast(static_cast<float>(terms.scale * terms.shear_modulus)) * rest;
    const Pack lambda = Floats::broadcast(static_cast<float>(terms.scale * terms.lambda)) * rest;
    const Vector nothing{none, none, none};
    const auto block_of = [&](const Vector& row, const Vector& column) {
      Matrix block = outer(scaled(row, lambda), column);
      const Vector across = scaled(column, mu);
      add_outer(block, across, row);
      Base::add_to_diagonal(block, dot(across, row));
      return block;
    };
    for (std::size_t k = 0; k < 4; ++k) {
      Base::store_rows(block_of(g[k], g[k]), nothing, lane, sums.corners[k]);
    }
    for (std::size_t e = 0; e < 6; ++e) {
      const Vector &first = g[kEdges[e][0]], &second = g[kEdges[e][1]];
      const Pack flip = Floats::load(t.flips + (n * 6 + e) * kLanes + lane);
      const Vector row = Base::chosen(flip, none, second, first);
      const Vector column = Base::chosen(flip, none, first, second);
      Base::store_rows(block_of(row, column), nothing, lane, sums.edges[e]);
    }
  }

  /// V (μ ‖F − R‖² + λ/2 (R:F − 3)²)
  static double energy(const ElementPart& part, const Tetrahedra& t, const ElementArrays& a,
                       const CorotationalTerms& terms) {
    double all = 0;
    for (std::size_t n = part.first_batch; n < part.first_batch + part.batch_count; ++n) {
      Lanes<double> energies{};
      for (std::size_t lane = 0; lane < kLanes; lane += Doubles::kWidth) {
        Wide edges[3], g[3];
        WidePack unused;
        Base::load_edges(t, a, n, lane, edges, unused);
        Base::load_gradients(t.gradients + n * 9 * kLanes, lane, g);
        const Matrix3<Doubles> F = Base::deformation_gradient(edges, g);
        const Matrix3<Doubles> R = NearestRotation<Doubles>::of(F);
        const Wide x = F.x - R.x, y = F.y - R.y, z = F.z - R.z;
        const WidePack turned = dot(x, x) + dot(y, y) + dot(z, z);
        const WidePack trace = dot(R.x, F.x) + dot(R.y, F.y) + dot(R.z, F.z);
        const WidePack stretch = trace - Doubles::broadcast(3);
        const WidePack density = Doubles::broadcast(terms.shear_modulus) * turned +
                                 Doubles::broadcast(terms.lambda / 2) * (stretch * stretch);
        Doubles::store(energies.of + lane, Doubles::load(t.volumes + n * kLanes + lane) * density);
      }
      all += Base::total(energies, Base::count_in(part, n));
    }
    return all;
  }

  static void assemble(const ElementPart& part, const Tetrahedra& t, const ElementArrays& a,
                       const CorotationalTerms& terms) {
    Base::template clear<false>(part, a);
    for (std::size_t n = part.first_batch; n < part.first_batch + part.batch_count; ++n) {
      Turned turned;
      BatchSums sums;
      for (std::size_t lane = 0; lane < kLanes; lane += Doubles::kWidth) {
        take_turned_forces(t, a, terms, n, lane, turned, sums);
      }
      for (std::size_t lane = 0; lane < kLanes; lane += Floats::kWidth) {
        take_turned_blocks(t, terms, n, lane, turned, sums);
      }
      Base::template add<false>(t, n, Base::count_in(part, n), sums, a);
    }
  }
};

template <class Floats, class Doubles>
inline constexpr ElementFunctions kElementFunctions{
    &PressureAssembly<Floats, Doubles>::take_volumes,
    &PressureAssembly<Floats, Doubles>::assemble,
    &CorotationalAssembly<Floats, Doubles>::assemble,
    &ElementProduct<Floats>::finish_volumes,
    &PressureAssembly<Floats, Doubles>::energy,
    &CorotationalAssembly<Floats, Doubles>::energy,
    &ElementProduct<Floats>::template multiply<true>,
    &ElementProduct<Floats>::template multiply<false>,
    &ElementProduct<Floats>::push,
    &ElementProduct<Floats>::collect};

}  // namespace
}  // namespace palpate::deformation::kernel
