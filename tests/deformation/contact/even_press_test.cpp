#include "deformation/contact/even_press.h"

#include <Eigen/LU>
#include <catch2/catch.hpp>

namespace palpate::deformation {
namespace {

/// A line of three numbers on springs k between them, the last also to the ground.
PressedPatch chain(double k, double damping) {
  PressedPatch patch;
  const Eigen::Matrix3f coupling{{1, -1, 0}, {-1, 2, -1}, {0, -1, 2}};
  patch.stiffness = static_cast<float>(k) * coupling;
  patch.damping = static_cast<float>(damping) * coupling;
  patch.masses = Eigen::Vector3d(2e-3, 1e-3, 3e-3);
  patch.push = Eigen::Vector3d(1, 0, 0);
  patch.volume = Eigen::Vector3d::Zero();
  return patch;
}

TEST_CASE("even press: a mass on a spring resists by m/T² + k (n − 1)/2n") {
  // Oracle: by hand, the mean of what n explicit steps need; a float's rounding.
  PressedPatch patch;
  patch.stiffness = Eigen::MatrixXf::Constant(1, 1, 50);
  patch.damping = Eigen::MatrixXf::Zero(1, 1);
  patch.masses = Eigen::VectorXd::Constant(1, 1e-3);
  patch.push = Eigen::VectorXd::Ones(1);
  patch.volume = Eigen::VectorXd::Zero(1);
  const double T = 4e-3;
  for (const int n : {1, 2, 5}) {
    const double resistance = 1e-3 / (T * T) + 50.0 * (n - 1) / (2 * n);
    CHECK(even_press_compliance(patch, T, n) == Approx(1 / resistance).epsilon(1e-6));
  }
}

TEST_CASE("even press: neighbours follow late, and a kept volume takes them along") {
  // Oracle: the same steps with the first place's way prescribed, one linear system a step: its
  // force and the volume's multiplier are unknowns. Two nodes beyond count in the volume.
  const double T = 4e-3, drag = 3;
  const int n = GENERATE(2, 4, 8);
  const bool keeps_volume = GENERATE(false, true);
  PressedPatch patch = chain(120, 0.02);
  patch.drag = drag;
  if (keeps_volume) {
    patch.volume = Eigen::Vector3d(2e-4, -1e-4, 3e-4);
    patch.volume_beyond = 4e-5;
  }
  const Eigen::Matrix3d K = patch.stiffness.cast<double>(), D = patch.damping.cast<double>();
  const double h = T / n;
  Eigen::Vector4d x = Eigen::Vector4d::Zero(), v = x;  // the last is all beyond, of mass 1
  Eigen::Vector4d masses, g;
  masses << patch.masses, 1;
  g << patch.volume, std::sqrt(patch.volume_beyond);
  double sum = 0;
  for (int j = 1; j <= n; ++j) {
    Eigen::Vector4d free = v;
    free.head<3>() -= h * (K * x.head<3>() + D * v.head<3>()).cwiseQuotient(patch.masses);
    free -= h * drag * v;
    // v + M⁻¹ g σ − M⁻¹ e₀ h p = free,  g·v = 0,  v₀ = 1/T
    Eigen::Matrix<double, 6, 6> A = Eigen::Matrix<double, 6, 6>::Identity();
    A(4, 4) = A(5, 5) = 0;
    A.block<4, 1>(0, 4) = g.cwiseQuotient(masses);
    A(0, 5) = -h / masses[0];
    A.block<1, 4>(4, 0) = g.transpose();
    A(5, 0) = 1;
    if (!keeps_volume) A(4, 4) = 1;
    Eigen::Matrix<double, 6, 1> b;
    b << free, 0, 1 / T;
    const Eigen::Matrix<double, 6, 1> found = A.fullPivLu().solve(b);
    v = found.head<4>();
    x += h * v;
    sum += found[5];
  }
  CHECK(even_press_compliance(patch, T, n) == Approx(n / sum).epsilon(1e-5));
}

TEST_CASE("even press: what cannot be stepped gives no number to go by") {
  // Oracle: the promise, "not positive".
  PressedPatch patch = chain(std::numeric_limits<double>::quiet_NaN(), 0);
  CHECK_FALSE(even_press_compliance(patch, 4e-3, 4) > 0);
}

}  // namespace
}  // namespace palpate::deformation
