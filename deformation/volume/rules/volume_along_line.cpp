#include "deformation/volume/rules/volume_along_line.h"

#include <cmath>
#include <numbers>

namespace palpate::deformation {
namespace {

/// Largest real root by magnitude of u³ + a u² + b u + c (Viète for three real roots, Cardano for
/// one).
double largest_root(double a, double b, double c) {
  const double q = (a * a - 3 * b) / 9;
  const double r = (2 * a * a * a - 9 * a * b + 27 * c) / 54;
  if (r * r >= q * q * q) {
    const double s = -std::copysign(std::cbrt(std::abs(r) + std::sqrt(r * r - q * q * q)), r);
    return s + (s == 0 ? 0 : q / s) - a / 3;
  }
  const double angle = std::acos(r / std::sqrt(q * q * q));
  double largest = 0;
  for (int k = -1; k <= 1; ++k) {
    const double root =
        -2 * std::sqrt(q) * std::cos((angle + 2 * std::numbers::pi * k) / 3) - a / 3;
    if (std::abs(root) > std::abs(largest)) largest = root;
  }
  return largest;
}

}  // namespace

std::array<double, 4> volume_along_line(const std::vector<geometry::Triangle>& triangles,
                                        const std::vector<Vec3>& positions,
                                        const std::vector<Vec3>& directions) {
  const Vec3& origin = positions[0];  // near it the digits are kept
  std::array<double, 4> sums{};
  for (const auto& [i, j, k] : triangles) {
    const Vec3 a = positions[i] - origin, b = positions[j] - origin, c = positions[k] - origin;
    const Vec3 &u = directions[i], &v = directions[j], &w = directions[k];
    const Vec3 v_cross_w = v.cross(w), b_cross_c = b.cross(c);
    const Vec3 mixed = b.cross(w) + v.cross(c);
    sums[0] += a.dot(b_cross_c);
    sums[1] += u.dot(b_cross_c) + a.dot(mixed);
    sums[2] += u.dot(mixed) + a.dot(v_cross_w);
    sums[3] += u.dot(v_cross_w);
  }
  for (double& sum : sums) sum /= 6;
  return sums;
}

std::optional<double> nearest_root(const std::array<double, 4>& cubic) {
  const auto [c0, c1, c2, c3] = cubic;
  if (c0 == 0) return 0.0;
  // In units of the linear root, s = t (−c₀/c₁), and with u = 1/t the cubic has a leading 1, its
  // root of least |t| is the one of largest |u|, near 1 when the line is nearly straight in V:
  // u³ − u² + β u + γ = 0.
  const double linear = -c0 / c1;
  const double beta = c2 * linear * linear / c0, gamma = c3 * linear * linear * linear / c0;
  if (!std::isfinite(beta) || !std::isfinite(gamma)) return std::nullopt;
  double u = largest_root(-1, beta, gamma);
  for (int k = 0; k < 3; ++k) {
    const double slope = (3 * u - 2) * u + beta;
    if (slope != 0) u -= (((u - 1) * u + beta) * u + gamma) / slope;
  }
  const double root = linear / u;
  return std::isfinite(root) ? std::optional<double>(root) : std::nullopt;
}

}  // namespace palpate::deformation
