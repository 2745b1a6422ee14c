#include "deformation/contact/far_answers.h"

#include <Eigen/LU>
#include <catch2/catch.hpp>

#include "deformation/springs/patch_springs.h"
#include "tests/deformation/organs.h"
#include "tests/deformation/springs/chunk_threads.h"
#include "tests/dense_algebra.h"

namespace palpate::deformation {
namespace {

TEST_CASE("far answers: A⁻¹ of a push along each axis, and what couples it to the near nodes") {
  // Oracle: the dense matrix in double, solved. All of a ball of 162 nodes, ten of them near.
  // Tolerances: conjugate gradients end at r·D⁻¹r 1e-3 of its start, which bounds the error in the
  // square of the norm of A by the condition of D⁻¹A; blocks are of the X found, by couplings of
  // eight binary digits.
  scene::Organ organ = testing::ball_organ();
  organ.springs.inner_ratio = 0;
  const OrganModel model = testing::ball_model(2, organ);
  const PatchSprings springs(model.network(), model.node_count());
  std::vector<Vec3> positions = model.rest_positions;
  for (Vec3& x : positions) x *= 1.05;
  const Neighbours neighbours(model, {});
  const std::vector<std::uint32_t> touched{3, 7};
  const Vec3 centre = 0.5 * (positions[3] + positions[7]);
  const std::vector<ComplianceRow> rows{{{{3, 0.4}, {7, 0.6}}, Vec3::UnitX()}};
  const SpringShares shares{.mass = 1 / 0.0025, .damping = 1 / 0.05, .stiffness = 1};
  constexpr Eigen::Index kNear = 10;

  FarAnswers far(model);
  far.find(positions, neighbours, touched, centre, kNear, model.node_count(), rows, shares);

  Patch patch;
  grow_patch(model, neighbours, positions, touched, centre, model.node_count(), patch);
  const auto size = static_cast<Eigen::Index>(3 * patch.nodes.size());
  REQUIRE(patch.nodes.size() == model.node_count());
  Eigen::MatrixXf stiffness = Eigen::MatrixXf::Zero(size, size), damping = stiffness;
  springs.add(positions, patch, stiffness, damping);
  const Eigen::MatrixXf lower = static_cast<float>(shares.stiffness) * stiffness +
                                static_cast<float>(shares.damping) * damping;
  Eigen::MatrixXd A = lower.selfadjointView<Eigen::Lower>().toDenseMatrix().cast<double>();
  Eigen::MatrixXd push = Eigen::MatrixXd::Zero(size, 3), X = push;
  for (std::size_t i = 0; i < patch.nodes.size(); ++i) {
    const std::uint32_t node = patch.nodes[i];
    const auto at = static_cast<Eigen::Index>(3 * i);
    A.diagonal().segment<3>(at).array() += shares.mass * model.masses[node];
    if (node == 3 || node == 7)
      push.block<3, 3>(at, 0) = (node == 3 ? 0.4 : 0.6) * Mat3::Identity();
    for (int k = 0; k < 3; ++k) {
      X.row(at + k) = far.load(node, Vec3::Unit(k)).cast<double>().transpose();
    }
  }
  const Eigen::MatrixXd exact = solved(A, push);
  CHECK(X.topRows(3 * kNear).isZero(0));
  Eigen::MatrixXd lack = X - exact;
  lack.topRows(3 * kNear).setZero();
  Eigen::MatrixXd D = Eigen::MatrixXd::Zero(size, size);
  for (Eigen::Index at = 0; at < size; at += 3) D.block<3, 3>(at, at) = A.block<3, 3>(at, at);
  const Eigen::VectorXd modes = eigenvalues_of(A, D);
  const double enough = 1e-3 * modes.maxCoeff() / modes.minCoeff();
  CHECK(enough < 0.1);  // else the next line says nothing
  CHECK((lack.transpose() * A * lack).trace() < enough * (exact.transpose() * A * exact).trace());
  CHECK(X.norm() > 0.2 * exact.norm());
  const Eigen::MatrixXd AX = A * X;
  constexpr double kDigits = 1. / 256;
  CHECK((far.near_block().cast<double>() - AX.topRows(3 * kNear)).norm() < kDigits * AX.norm());
  const Mat3 own = X.transpose() * AX;
  CHECK((far.own_block().cast<double>() - own).norm() < kDigits * own.norm());
  const auto at = static_cast<Eigen::Index>(3 * patch.place(7));
  const Mat3 alone = A.block<3, 3>(at, at).inverse();
  REQUIRE(far.alone(7) != nullptr);
  CHECK((*far.alone(7) - alone).norm() < kDigits * alone.norm());
}

TEST_CASE("far answers: the same bits on any number of threads") {
  // Oracle: itself on one. A patch of more slices than threads are given at a time.
  const OrganModel model = testing::ball_model(4);
  const Neighbours neighbours(model, {});
  const std::vector<std::uint32_t> touched{3, 7};
  const std::vector<ComplianceRow> rows{{{{3, 0.4}, {7, 0.6}}, Vec3::UnitX()}};
  const SpringShares shares{.mass = 1 / 0.0025, .damping = 1 / 0.05, .stiffness = 1};
  const auto find = [&](FarAnswers& far) {
    far.find(model.rest_positions, neighbours, touched, model.rest_positions[3], 10,
             model.node_count(), rows, shares);
  };
  FarAnswers alone(model);
  find(alone);
  CHECK(alone.own_block().norm() > 0);
  for (const std::size_t count : {2u, 3u}) {
    testing::ChunkThreads threads(count);
    FarAnswers far(model, &threads);
    find(far);
    CHECK(far.near_block() == alone.near_block());
    CHECK(far.own_block() == alone.own_block());
    CHECK(far.load(100, Vec3::UnitX()) == alone.load(100, Vec3::UnitX()));
  }
}

}  // namespace
}  // namespace palpate::deformation
