#include "deformation/contact/coupled_inverse_mass.h"

#include <Eigen/LU>
#include <catch2/catch.hpp>
#include <random>

#include "tests/dense_algebra.h"

namespace palpate::deformation {
namespace {

TEST_CASE("coupled inverse mass: no step down the gradient overshoots, however many couplings") {
  // Oracle: eigenvalues of the dense W⁻¹ − Σ couplings − W₀⁻¹; a step by W never overshoots where
  // none is negative. Without the couplings in W one is, by as much as they are stiff.
  constexpr std::uint32_t kNodes = 7;
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const auto any = [&] { return Vec3(normal(random), normal(random), normal(random)); };
  std::vector<Mat3> blocks(kNodes);
  for (Mat3& block : blocks) {
    const Vec3 a = any(), b = any();
    block = Mat3::Identity() + a * a.transpose() + b * b.transpose();
  }
  blocks[6].setZero();  // fixed
  const std::vector<Mat3> without = blocks;
  Eigen::MatrixXd coupled = Eigen::MatrixXd::Zero(3 * kNodes, 3 * kNodes);
  for (std::uint32_t c = 0; c < 30; ++c) {
    ContactCoupling coupling;
    coupling.nodes = {c % kNodes, (c + 1) % kNodes, (c + 3) % kNodes};
    Eigen::VectorXd arms = Eigen::VectorXd::Zero(3 * kNodes);
    const Vec3 along = any();
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 arm = (k == 2 && c % 4 == 0 ? 0 : normal(random)) * along;
      coupling.arms[k] = wide(arm);
      if (coupling.nodes[k] != 6) arms.segment<3>(3 * coupling.nodes[k]) = arm;
    }
    coupled += arms * arms.transpose();
    take_coupling(coupling, blocks);
  }
  CHECK(blocks[6].isZero(0));
  const auto least = [&](const std::vector<Mat3>& inverse) {
    Eigen::MatrixXd rest = -coupled;
    for (std::uint32_t i = 0; i + 1 < kNodes; ++i) {
      rest.block<3, 3>(3 * i, 3 * i) += inverse[i].inverse() - without[i].inverse();
    }
    return eigenvalues_of(rest)[0];
  };
  CHECK(least(blocks) > -1e-5 * coupled.norm());  // arms are floats
  CHECK(least(without) < -0.1 * coupled.norm());
}

}  // namespace
}  // namespace palpate::deformation
