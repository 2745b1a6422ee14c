#include "deformation/linear_algebra/patch_matrix.h"

#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <random>

namespace palpate::deformation {
namespace {

TEST_CASE("patch matrix: applied, its diagonal and p·A p are those of the dense matrix") {
  // Oracle: the same blocks in a dense matrix. Tolerance: float, a row of 4 blocks.
  constexpr int kRows = 7;
  std::mt19937 random(3);
  std::uniform_real_distribution<float> any(-1, 1);
  Eigen::MatrixXf dense = Eigen::MatrixXf::Zero(3 * kRows, 3 * kRows);
  PatchMatrix matrix;
  for (int round = 0; round < 2; ++round) {  // it forgets what it was
    dense.setZero();
    matrix.clear();
    for (int i = 0; i < kRows; ++i) {
      for (const int j : {i, (i + 1) % kRows, (i + 3) % kRows, (i + 5) % kRows}) {
        Block4f block{Vec4f::Zero(), Vec4f::Zero(), Vec4f::Zero()};
        for (std::size_t c = 0; c < 3; ++c) {
          for (int r = 0; r < 3; ++r) block[c][r] = any(random);
          dense.block<3, 1>(3 * i, 3 * j + static_cast<int>(c)) = block[c].head<3>();
        }
        matrix.add(static_cast<std::uint32_t>(j), block);
      }
      matrix.end_row();
    }
  }
  REQUIRE(matrix.rows() == kRows);
  Eigen::VectorXf p = Eigen::VectorXf::Random(3 * kRows);
  for (int i = 0; i < kRows; ++i) {
    matrix.nodes()[static_cast<std::size_t>(i)].vector << p.segment<3>(3 * i), 0;
    const Eigen::Matrix3f diagonal = dense.block<3, 3>(3 * i, 3 * i);
    CHECK(matrix.diagonal(static_cast<std::size_t>(i)) == diagonal);
  }
  std::vector<Vec4f> out(kRows);
  const double curvature = matrix.apply(out);
  const Eigen::VectorXf product = dense * p;
  for (int i = 0; i < kRows; ++i) {
    CHECK((out[static_cast<std::size_t>(i)].head<3>() - product.segment<3>(3 * i)).norm() < 1e-5f);
  }
  CHECK(curvature == Approx(p.dot(product)).margin(1e-5));
}

}  // namespace
}  // namespace palpate::deformation
