#include "deformation/volume/rules/volume_along_line.h"

#include <catch2/catch.hpp>

#include "method_checks.h"
#include "tests/dense_algebra.h"

namespace palpate::deformation {
namespace {

TEST_CASE("volume along a line: the cubic is the enclosed volume everywhere on it") {
  // Oracle: enclosed_volume() of the moved surface; to rounding.
  const auto model = testing::ball_model(2);
  const auto state = testing::shaken_state(model, 5e-3, 0.05);
  const auto [c0, c1, c2, c3] =
      volume_along_line(model.triangles, state.positions, state.velocities);
  for (const double s : {-2.0, -0.3, 0.0, 0.1, 1.0, 3.0}) {
    auto moved = state;
    for (std::size_t i = 0; i < model.node_count(); ++i) {
      moved.positions[i] += s * state.velocities[i];
    }
    CHECK(((c3 * s + c2) * s + c1) * s + c0 ==
          Approx(testing::volume_of(model, moved)).epsilon(1e-11).margin(1e-15));
  }
}

/// Of the real roots of the companion matrix the one nearest to zero.
double nearest_eigenvalue(const std::array<double, 4>& c) {
  Eigen::MatrixXd companion(3, 3);
  companion << 0, 0, -c[0] / c[3], 1, 0, -c[1] / c[3], 0, 1, -c[2] / c[3];
  const Eigen::VectorXcd roots = roots_of(companion);
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& root : roots) {
    if (std::abs(root.imag()) > 1e-9 * std::abs(root)) continue;
    if (std::abs(root.real()) < std::abs(nearest)) nearest = root.real();
  }
  return nearest;
}

TEST_CASE("nearest root: agrees with the eigenvalues of the companion matrix") {
  // Oracle: Eigen's eigenvalue solver. Double roots have few digits in either: 1e-6.
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(-1, 1);
  int three_roots = 0;
  for (int n = 0; n < 2000; ++n) {
    const std::array<double, 4> c{any(random), any(random), any(random), any(random)};
    const auto root = nearest_root(c);
    REQUIRE(root);
    INFO(c[0] << " " << c[1] << " " << c[2] << " " << c[3]);
    CHECK(*root == Approx(nearest_eigenvalue(c)).epsilon(1e-6));
    CHECK(std::abs(((c[3] * *root + c[2]) * *root + c[1]) * *root + c[0]) <
          1e-12 * (1 + std::abs(*root * *root * *root)));
    const double discriminant = 18 * c[3] * c[2] * c[1] * c[0] - 4 * c[2] * c[2] * c[2] * c[0] +
                                c[2] * c[2] * c[1] * c[1] - 4 * c[3] * c[1] * c[1] * c[1] -
                                27 * c[3] * c[3] * c[0] * c[0];
    three_roots += discriminant > 0;
  }
  CHECK(three_roots > 200);  // both branches were taken
  CHECK(three_roots < 1800);
}

TEST_CASE("nearest root: a line, a parabola, no error, and no way") {
  // Oracle: by hand.
  CHECK(*nearest_root({-2, 4, 0, 0}) == Approx(0.5));
  CHECK(*nearest_root({0.75, -2, 1, 0}) == Approx(0.5));
  CHECK(*nearest_root({0, 4, 1, 1}) == 0);
  CHECK_FALSE(nearest_root({1, 0, 0, 0}));
  CHECK_FALSE(nearest_root({std::nan(""), 1, 0, 0}));
}

}  // namespace
}  // namespace palpate::deformation
