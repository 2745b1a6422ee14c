#include "modules/core/polar_decomposition.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <catch2/catch.hpp>

namespace palpate {
namespace {

/// By singular values, the least one turned round where det F < 0.
Mat3 nearest_rotation_by_svd(const Mat3& F) {
  const Eigen::JacobiSVD<Mat3> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Mat3 sign = Mat3::Identity();
  sign(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  return svd.matrixU() * sign * svd.matrixV().transpose();
}

TEST_CASE("nearest rotation: agrees with singular values, inside out or not") {
  // Oracle: independent method. Random matrices are ill conditioned at times: 1e-8.
  std::srand(5);
  for (int k = 0; k < 500; ++k) {
    const Mat3 F = Mat3::Random();
    CHECK((nearest_rotation(F) - nearest_rotation_by_svd(F)).norm() < 1e-8);
  }
  CHECK(nearest_rotation(Mat3::Identity()) == Mat3::Identity());
  CHECK(nearest_rotation(Mat3::Zero()) == Mat3::Identity());
  const Mat3 half_turn = Vec3(1, -1, -1).asDiagonal();
  CHECK((nearest_rotation(half_turn) - half_turn).norm() < 1e-12);
  CHECK(nearest_rotation(-Mat3::Identity()).allFinite());
}

}  // namespace
}  // namespace palpate
