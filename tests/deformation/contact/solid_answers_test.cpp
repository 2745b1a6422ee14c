#include "deformation/contact/solid_answers.h"

#include <Eigen/LU>
#include <algorithm>
#include <catch2/catch.hpp>

#include "tests/deformation/steppers/tetrahedral_solids.h"
#include "tests/dense_algebra.h"

namespace palpate::deformation {
namespace {

/// A cube of 125 nodes, its bottom held, and what a step of 10 ms made of it, a third of its
/// masses' share and half of its stiffness'.
struct SteppedCube {
  static constexpr double kStep = 0.01;
  OrganModel model;
  std::unique_ptr<OrganDynamics> dynamics;
  OrganState state;
  SpringShares shares{.mass = 1 / (3 * kStep * kStep), .damping = 0, .stiffness = 0.5};
  Eigen::MatrixXd A;                ///< of all nodes, those that are fixed by themselves
  std::vector<std::uint32_t> tops;  ///< nodes from the one furthest along (1, 1, 1) on
  std::vector<ComplianceRow> rows;

  explicit SteppedCube(const scene::Organ& organ)
      : model(testing::cube_model(organ)),
        dynamics(make_dynamics(organ, model, kStep)),
        state(rest_state(model)) {
    for (std::uint32_t i = 0; i < model.node_count(); ++i) tops.push_back(i);
    std::ranges::stable_sort(tops, std::greater{},
                             [&](std::uint32_t i) { return model.rest_positions[i].sum(); });
    rows = {{{{tops[0], 0.4}, {tops[1], 0.6}}, Vec3::UnitX()}, {{{tops[2], 1.0}}, Vec3::UnitZ()}};
    state.positions = testing::shaken(model, 1e-3);
    dynamics->step(kStep, {}, state);
    Patch all;
    all.places.assign(model.node_count(), -1);
    for (std::uint32_t i = 0; i < model.node_count(); ++i) {
      all.places[i] = static_cast<std::int32_t>(i);
      all.nodes.push_back(i);
    }
    Eigen::MatrixXf lower = Eigen::MatrixXf::Zero(size(), size());
    dynamics->add_stiffness(all, lower);
    A = shares.stiffness * lower.selfadjointView<Eigen::Lower>().toDenseMatrix().cast<double>();
    for (std::uint32_t i = 0; i < model.node_count(); ++i) {
      const auto at = static_cast<Eigen::Index>(3 * i);
      A.diagonal().segment<3>(at).array() += shares.mass * model.masses[i];
      if (model.inverse_masses[i] > 0) continue;
      A.middleRows<3>(at).setZero();
      A.middleCols<3>(at).setZero();
      A.block<3, 3>(at, at).setIdentity();
    }
  }
  Eigen::Index size() const { return static_cast<Eigen::Index>(3 * model.node_count()); }
  /// Of a push along each axis spread over the rows.
  Eigen::MatrixXd exact() const {
    Eigen::MatrixXd push = Eigen::MatrixXd::Zero(size(), 3);
    for (const ComplianceRow& row : rows) {
      for (const auto& [node, weight] : row.weights) {
        push.block<3, 3>(static_cast<Eigen::Index>(3 * node), 0) +=
            weight / static_cast<double>(rows.size()) * Mat3::Identity();
      }
    }
    return solved(A, push);
  }
  Patch near() const {
    Patch patch;
    patch.places.assign(model.node_count(), -1);
    for (std::int32_t i = 0; i < 4; ++i) {
      patch.nodes.push_back(tops[static_cast<std::size_t>(i)]);
      patch.places[patch.nodes.back()] = i;
    }
    return patch;
  }
  Eigen::MatrixXf pressed(const Patch& near) const {
    const auto count = static_cast<Eigen::Index>(3 * near.nodes.size());
    Eigen::MatrixXf block = Eigen::MatrixXf::Zero(count, count);
    const auto place = [&](Eigen::Index k) {
      return static_cast<Eigen::Index>(3 * near.nodes[static_cast<std::size_t>(k / 3)]) + k % 3;
    };
    for (Eigen::Index i = 0; i < count; ++i) {
      for (Eigen::Index j = 0; j <= i; ++j) {
        block(i, j) = static_cast<float>(A(place(i), place(j)));
      }
    }
    return block;
  }
  void find(SolidAnswers& answers) const {
    answers.find(dynamics->step_matrix(), shares, near(), pressed(near()), rows);
  }
  Eigen::MatrixXd found(const SolidAnswers& answers) const {
    Eigen::MatrixXd X(size(), 3);
    for (std::uint32_t node = 0; node < model.node_count(); ++node) {
      for (int k = 0; k < 3; ++k) {
        X.row(3 * node + k) = answers.load(node, Vec3::Unit(k)).cast<double>().transpose();
      }
    }
    return X;
  }
};

SteppedCube stepped_cube(const char* word) {
  scene::Organ organ = testing::solid_organ(word, 0.45);
  organ.fixed.push_back(scene::BoxRegion{Vec3(-1, -1, -1), Vec3(1, 1, 1e-3)});
  return SteppedCube(organ);
}

TEST_CASE("solid answers: A⁻¹ of a push along each axis, and what couples it to the near nodes") {
  // Oracle: the dense matrix in double, solved; of each model that steps with elements. Tolerances:
  // after eight iterations a fifth of the work of the push may be lacking, the error in the square
  // of the norm of A; blocks are of the X found, in float.
  for (const char* word : {"nodal_pressure", "corotational", "quadratic_pressure"}) {
    INFO(word);
    const SteppedCube cube = stepped_cube(word);
    const Patch near = cube.near();
    SolidAnswers answers(cube.model);
    cube.find(answers);
    const Eigen::MatrixXd X = cube.found(answers), exact = cube.exact();
    Eigen::MatrixXd lack = X - exact;
    for (const std::uint32_t node : near.nodes) {
      CHECK(X.middleRows<3>(3 * node).isZero(0));
      lack.middleRows<3>(3 * node).setZero();
    }
    for (const std::uint32_t node : cube.model.fixed_nodes) {
      CHECK(X.middleRows<3>(3 * node).isZero(0));
      CHECK(answers.alone(node).isZero(0));
    }
    CHECK((lack.transpose() * cube.A * lack).trace() <
          0.2 * (exact.transpose() * cube.A * exact).trace());
    CHECK(X.norm() > 0.2 * exact.norm());
    const Eigen::MatrixXd AX = cube.A * X;
    const Eigen::MatrixXf& block = answers.near_block();
    double off = 0;
    for (std::size_t i = 0; i < near.nodes.size(); ++i) {
      const Eigen::MatrixXd found =
          block.middleRows<3>(static_cast<Eigen::Index>(3 * i)).cast<double>();
      off = std::max(off, (found - AX.middleRows<3>(3 * near.nodes[i])).norm() / AX.norm());
    }
    CHECK(off < 1e-4);
    const Mat3 own = X.transpose() * AX;
    CHECK((answers.own_block().cast<double>() - own).norm() / own.norm() < 1e-4);
    const auto at = static_cast<Eigen::Index>(3 * cube.tops[4]);
    const Mat3 alone = cube.A.block<3, 3>(at, at).inverse();
    CHECK((answers.alone(cube.tops[4]) - alone).norm() / alone.norm() < 1e-4);
  }
}

TEST_CASE("solid answers: they begin with what was found before, and can forget it") {
  // Oracle: the exact answer is nearer after a second go at the same touch than after one; another
  // touch, to which what was found is no help, gets what it would get alone, to the bit; so does
  // one after forget(). One that begins with another's goes on as that one does.
  SteppedCube cube = stepped_cube("nodal_pressure");
  const Patch near = cube.near();
  const auto find = [&](SolidAnswers& answers) {
    cube.find(answers);
    return cube.found(answers);
  };
  const auto lack = [&](const Eigen::MatrixXd& X) {
    Eigen::MatrixXd off = X - cube.exact();
    for (const std::uint32_t node : near.nodes) off.middleRows<3>(3 * node).setZero();
    return (off.transpose() * cube.A * off).trace();
  };
  SolidAnswers answers(cube.model);
  const Eigen::MatrixXd once = find(answers);
  cube.rows[0].weights = {{cube.tops[0], 0.5}, {cube.tops[1], 0.5}};
  const Eigen::MatrixXd again = find(answers);
  SolidAnswers fresh(cube.model);
  CHECK(lack(again) < lack(find(fresh)));
  SolidAnswers successor(cube.model);
  successor.begin_with(answers, [](const std::vector<Vec4f>& ways) { return ways; });
  CHECK(find(successor) == find(answers));
  answers.forget();
  fresh.forget();
  CHECK(find(answers) == find(fresh));

  cube.rows = {{{{cube.tops[60], 1.0}}, Vec3::UnitZ()}};
  SolidAnswers alone(cube.model);
  CHECK(find(answers) == find(alone));
  CHECK(once != again);
}

}  // namespace
}  // namespace palpate::deformation
