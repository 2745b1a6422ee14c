#include "deformation/steppers/modal_analysis.h"

#include <catch2/catch.hpp>

#include "deformation/steppers/quasi_static_newton.h"
#include "tests/deformation/elements/solids.h"

namespace palpate::deformation {
namespace {

TEST_CASE("modal analysis: none is missed, and modes are orthonormal") {
  // Oracle: Sturm count, negative pivots of K − ω²M less the pressures; UᵀMU = 1.
  const auto solid = testing::solid(testing::block({0.02, 0.03, 0.05}, 2, 2, 3), 0.49);
  std::vector<char> held(solid.displacement_count(), 0);
  for (std::size_t i = 0; i < solid.mesh().nodes.size(); ++i) {
    if (solid.mesh().nodes[i].z() == 0) held[3 * i] = held[3 * i + 1] = held[3 * i + 2] = 1;
  }
  const auto vibration = modal_analysis(solid, held, 8);
  QuasiStaticNewton solver(solid, held, nullptr);
  const auto rest = solid.rest_state();
  for (std::size_t k = 0; k + 1 < 8; ++k) {
    const double w = (vibration.angular_frequencies[k] + vibration.angular_frequencies[k + 1]) / 2;
    REQUIRE(solver.factor(rest, Inertia{-w * w, rest.positions}));
    CHECK(solver.factorisation().negative_pivots() == solid.mesh().corner_count + k + 1);
  }
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(8, 8);
  for (std::size_t e = 0; e < solid.element_count(); ++e) {
    const auto& nodes = solid.mesh().elements[e];
    for (int i = 0; i < 3; ++i) {
      std::array<Eigen::Index, kElementNodes> rows{};
      for (std::size_t a = 0; a < rows.size(); ++a) rows[a] = 3 * nodes[a] + i;
      const Eigen::MatrixXd part = vibration.modes(rows, Eigen::all);
      gram += part.transpose() * solid.mass(e) * part;
    }
  }
  CHECK((gram - Eigen::MatrixXd::Identity(8, 8)).norm() < 1e-6);
  const Eigen::MatrixXd by_momenta = vibration.modes.transpose() * vibration.momenta;
  CHECK((by_momenta - gram).norm() < 1e-9);
}

TEST_CASE("modal analysis: pressures are those the bulk modulus answers the shapes' volumes with") {
  // Oracle: the definition of p, ∫ L (J − 1 − p/κ) dV = 0, linearised by a small amplitude.
  const auto solid = testing::solid(testing::block({0.04, 0.04, 0.04}, 2, 2, 2), 0.4);
  std::vector<char> held(solid.displacement_count(), 0);
  std::fill(held.begin(), held.begin() + 75, 1);
  const auto vibration = modal_analysis(solid, held, 3);
  for (int k = 0; k < 3; ++k) {
    auto state = solid.rest_state();
    const double amplitude = 1e-7 / vibration.modes.col(k).cwiseAbs().maxCoeff();
    for (std::size_t i = 0; i < state.positions.size(); ++i) {
      state.positions[i] +=
          amplitude * vibration.modes.col(k).segment<3>(static_cast<Eigen::Index>(3 * i));
    }
    const auto corners = static_cast<Eigen::Index>(solid.mesh().corner_count);
    QuasiStaticNewton solver(solid, held, nullptr);
    const double without = solver.residual(state, {}).tail(corners).norm();
    state.pressures = amplitude * vibration.pressures.col(k);
    CHECK(solver.residual(state, {}).tail(corners).norm() < 1e-3 * without);
  }
}

TEST_CASE("modal analysis: a free body has six rigid motions") {
  // Oracle: mechanics. ω of the seventh is that of a shear wave across the block, to a factor 2.
  const auto solid = testing::solid(testing::block({0.04, 0.04, 0.04}, 2, 2, 2), 0.499);
  const auto vibration = modal_analysis(solid, std::vector<char>(solid.displacement_count(), 0), 7);
  const double wave = 3.14159 * std::sqrt(solid.tissue().shear_modulus() / 1000) / 0.04;
  CHECK(vibration.angular_frequencies[5] < 1e-2 * wave);
  CHECK(vibration.angular_frequencies[6] > 0.5 * wave);
  CHECK(vibration.angular_frequencies[6] < 2 * wave);
}

}  // namespace
}  // namespace palpate::deformation
