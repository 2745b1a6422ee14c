#include "deformation/contact/closing_rows.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "deformation/contact/compliance_row.h"
#include "tests/deformation/organs.h"
#include "tests/dense_algebra.h"

namespace palpate::deformation {
namespace {

using testing::kPeriod;

/// The mean force [N] on a plate that moves evenly by `way` in kPeriod, from `gap` before a free
/// mass of 1 kg at rest: n steps, in each the mass gets what it needs not to be inside.
double force_of_mass(double gap, double way, int steps) {
  const double h = kPeriod / steps;
  double x = 0, v = 0, impulse = 0;
  for (int j = 1; j <= steps; ++j) {
    const double plate = way * j / steps - gap;
    const double push = std::max(0.0, (plate - x) / h - v);
    v += push;
    impulse += push;
    x += h * v;
  }
  return impulse / kPeriod;
}

TEST_CASE("closing rows: a place is as stiff as a mass met on the ways that a probe may take") {
  // Oracle: a mass and a plate stepped, for 400 ways within kWay of the one expected; the mean of
  // their differences, over m/T² of one that is pressed all along. 0.02 n: one way more or less,
  // and the rim of the differences.
  const double way = 8e-5, off = 1e-8;
  for (const int steps : {1, 2, 3, 6}) {
    for (const double gap : {0.1 * way, 0.45 * way, 0.7 * way}) {
      INFO("n " << steps << ", gap " << gap / way);
      double mean = 0;
      for (int i = 0; i < 400; ++i) {
        const double there = way * (1 - kWay + 2 * kWay * (i + 0.5) / 400);
        mean += (force_of_mass(gap, there + off, steps) - force_of_mass(gap, there - off, steps)) /
                (2 * off) * kPeriod * kPeriod / 400;
      }
      LawRow row;
      row.gap = gap;
      const double found = stiffer_by_closing(row, Vec3(0, 0, -way), kPeriod, steps);
      CHECK(found == Approx(mean).margin(0.02 * steps));
    }
  }
}

TEST_CASE("closing rows: what presses, is out of reach or has one step is as before") {
  // Oracle: definition.
  LawRow row;
  row.gap = 7e-5;
  CHECK(stiffer_by_closing(row, Vec3(0, 0, -8e-5), kPeriod, 1) == 1);
  CHECK(stiffer_by_closing(row, Vec3(0, 0, -6e-5), kPeriod, 4) == 1);
  CHECK(stiffer_by_closing(row, Vec3(0, 0, 8e-5), kPeriod, 4) == 1);
  CHECK(stiffer_by_closing(row, Vec3(0, 0, -8e-5), kPeriod, 4) > 1);
  row.velocity = Vec3(0, 0, 8e-5 / kPeriod);  // tissue comes
  CHECK(stiffer_by_closing(row, Vec3::Zero(), kPeriod, 4) > 1);
  row.gap = 0;
  CHECK(stiffer_by_closing(row, Vec3(0, 0, -8e-5), kPeriod, 4) == 1);
}

TEST_CASE("closing rows: what they give way by themselves is divided, the rest stays") {
  // Oracle: the Schur complement of a dense W, and its eigenvalues.
  Eigen::MatrixXd half(4, 4);
  half << 3, 1, 0, 1, 1, 2, 1, 0, 0, 1, 2, 1, 1, 0, 1, 3;
  const Eigen::MatrixXd before = half * half.transpose();
  Eigen::MatrixXd W = before;
  const double stiffer[] = {1, 4};  // of two rows with two directions each
  stiffen_closing_rows(stiffer, W);
  const auto own = [](const Eigen::MatrixXd& M) -> Eigen::MatrixXd {
    return M.bottomRightCorner(2, 2) -
           M.bottomLeftCorner(2, 2) * inverse_of(M.topLeftCorner(2, 2)) * M.topRightCorner(2, 2);
  };
  Eigen::MatrixXd regular = before;
  regular.diagonal() *= 1 + kRegular;
  CHECK((own(W) - own(regular) / 4).norm() < 1e-12 * before.norm());
  CHECK((W.topRows(2) - regular.topRows(2)).norm() < 1e-12 * before.norm());
  CHECK(eigenvalues_of(W)[0] > 0);
  // Of what is no compliance nothing is made.
  Eigen::MatrixXd odd = -Eigen::MatrixXd::Identity(2, 2);
  const double both[] = {4, 4};
  stiffen_closing_rows(both, odd);
  CHECK(odd == -Eigen::MatrixXd::Identity(2, 2));
}

TEST_CASE("closing rows: of rows on one place rounding decides nothing") {
  // Oracle: definition: rows on one place are as one, whose compliance is divided; with rounding of
  // either sign in W, by which it is regular or not.
  for (const double rounding : {-1e-15, 0.0, 1e-15}) {
    for (const int rows : {1, 2, 3}) {
      INFO(rows << " rows, rounding " << rounding);
      Eigen::MatrixXd W = Eigen::MatrixXd::Constant(rows, rows, 4e-3);
      W(rows - 1, rows - 1) *= 1 + rounding;
      const std::vector<double> stiffer(static_cast<std::size_t>(rows), 3);
      stiffen_closing_rows(stiffer, W);
      CHECK((W.array() / (4e-3 / 3) - 1).abs().maxCoeff() < 3 * kRegular);
    }
  }
}

}  // namespace
}  // namespace palpate::deformation
