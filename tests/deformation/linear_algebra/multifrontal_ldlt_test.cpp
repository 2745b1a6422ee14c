#include "deformation/linear_algebra/multifrontal_ldlt.h"

#include <catch2/catch.hpp>

#include "modules/core/error.h"
#include "tests/deformation/elements/solids.h"
#include "tests/dense_algebra.h"

namespace palpate::deformation {
namespace {

struct System {
  TaylorHoodElements solid = testing::solid(testing::block({0.03, 0.02, 0.02}, 3, 2, 2), 0.499);
  SolidState state = testing::shaken(solid, 1e-4);
  std::vector<std::vector<int>> dofs;
  std::vector<Vec3> centres;
  Eigen::MatrixXd dense;  ///< the same matrix, unknowns left out as unit rows

  System() {
    dense.setZero(static_cast<Eigen::Index>(solid.dof_count()),
                  static_cast<Eigen::Index>(solid.dof_count()));
    ElementMatrix local;
    for (std::size_t e = 0; e < solid.element_count(); ++e) {
      const auto all = solid.dofs(e);
      dofs.emplace_back(all.begin(), all.end());
      centres.push_back(solid.mesh().nodes[solid.mesh().elements[e][5]]);
      solid.tangent(e, state, local);
      for (int& dof : dofs.back()) {
        if (is_held(dof)) dof = -1;
      }
      for (int i = 0; i < kElementDofs; ++i) {
        for (int j = 0; j < kElementDofs; ++j) {
          if (dofs[e][i] >= 0 && dofs[e][j] >= 0) dense(dofs[e][i], dofs[e][j]) += local(i, j);
        }
      }
    }
    for (Eigen::Index d = 0; d < dense.rows(); ++d) {
      if (is_held(static_cast<int>(d))) dense(d, d) = 1;
    }
  }
  bool is_held(int dof) const {
    const auto node = static_cast<std::size_t>(dof) / 3;
    return node < solid.mesh().nodes.size() && solid.mesh().nodes[node].x() == 0;
  }
};

TEST_CASE("multifrontal LDLᵀ: solves what a dense factorisation solves, several columns at once") {
  // Oracle: Eigen's dense LU of the same matrix; residual relative to the right-hand side.
  const System system;
  MultifrontalLdlt factor(system.solid.dof_count(), system.dofs, system.centres);
  ElementMatrix matrix;
  REQUIRE(factor.factor([&](std::size_t e) -> Eigen::Ref<const Eigen::MatrixXd> {
    system.solid.tangent(e, system.state, matrix);
    return matrix;
  }));
  Eigen::MatrixXd b = Eigen::MatrixXd::Zero(system.dense.rows(), 3);
  for (Eigen::Index d = 0; d < b.rows(); ++d) {
    if (system.is_held(static_cast<int>(d))) continue;
    for (int c = 0; c < 3; ++c) b(d, c) = testing::noise(static_cast<std::size_t>(3 * d + c));
  }
  Eigen::MatrixXd x = b;
  factor.solve(x);
  const Eigen::MatrixXd exact = solved(system.dense, b);
  CHECK((x - exact).norm() < 1e-8 * exact.norm());
  CHECK((system.dense * x - b).norm() < 1e-9 * b.norm());
}

TEST_CASE("multifrontal LDLᵀ: pivots count negative eigenvalues, one per pressure") {
  // Oracle: dense eigenvalues; Sylvester's law of inertia.
  const System system;
  MultifrontalLdlt factor(system.solid.dof_count(), system.dofs, system.centres);
  ElementMatrix matrix;
  REQUIRE(factor.factor([&](std::size_t e) -> Eigen::Ref<const Eigen::MatrixXd> {
    system.solid.tangent(e, system.state, matrix);
    return matrix;
  }));
  const Eigen::VectorXd values = eigenvalues_of(system.dense);
  CHECK(factor.negative_pivots() == static_cast<std::size_t>((values.array() < 0).count()));
  CHECK(factor.negative_pivots() == system.solid.mesh().corner_count);
  matrix.setZero();
  CHECK_FALSE(
      factor.factor([&](std::size_t) -> Eigen::Ref<const Eigen::MatrixXd> { return matrix; }));
}

TEST_CASE("multifrontal LDLᵀ: asks to go on within fronts, and factors anew after it was stopped") {
  // Oracle: a factorisation that was never stopped, to the bit.
  const System system;
  MultifrontalLdlt factor(system.solid.dof_count(), system.dofs, system.centres);
  ElementMatrix matrix;
  const auto matrix_of = [&](std::size_t e) -> Eigen::Ref<const Eigen::MatrixXd> {
    system.solid.tangent(e, system.state, matrix);
    return matrix;
  };
  int asked = 0;
  REQUIRE(factor.factor(matrix_of, [&] { ++asked; }));
  const int most = asked;
  for (const int stop : {1, most / 2, most}) {
    asked = 0;
    const auto keep_going = [&] {
      if (++asked == stop) throw Interrupted("stopped");
    };
    CHECK_THROWS_AS(factor.factor(matrix_of, keep_going), Interrupted);
  }
  REQUIRE(factor.factor(matrix_of));
  MultifrontalLdlt never_stopped(system.solid.dof_count(), system.dofs, system.centres);
  REQUIRE(never_stopped.factor(matrix_of));
  Eigen::MatrixXd x = Eigen::MatrixXd::Ones(system.dense.rows(), 1), expected = x;
  factor.solve(x);
  never_stopped.solve(expected);
  CHECK(x == expected);
}

}  // namespace
}  // namespace palpate::deformation
