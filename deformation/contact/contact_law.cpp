#include "deformation/contact/contact_law.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>

#include "deformation/contact/compliance_row.h"

namespace palpate::deformation {
namespace {

/// A row whose friction is nearer to its cone than this slides.
constexpr double kSlidingFraction = 0.99;

bool slides(const LawRow& row, double friction) {
  const double pressing = row.normal.dot(row.force);
  const Vec3 dragging = row.force - pressing * row.normal;
  return dragging.norm() >= kSlidingFraction * friction * pressing;
}

/// Two ways to the same stiffness differ by less, where W is no more regular than that.
constexpr double kRounding = 1 + 1e-3;

/// A law's rows in the plain form of linear algebra.
struct LawMatrices {
  Eigen::MatrixXd compliance;           ///< W  (directions, directions)
  Eigen::MatrixXd axes;                 ///< how a row's place moves  (directions, 3)
  std::vector<Eigen::Index> pressing;   ///< directions of the rows that press
  std::vector<Eigen::Index> unlimited;  ///< of these, whose force the friction cone leaves free
  Eigen::MatrixXd forces;  ///< in all directions, of 1 N in an unlimited one  (directions, count)
};

LawMatrices matrices_of(const LocalLaw& law) {
  const std::size_t per_row = law.directions();
  const auto size = static_cast<Eigen::Index>(per_row * law.rows.size());
  LawMatrices m{Eigen::MatrixXd(size, size),
                Eigen::MatrixXd(size, 3),
                {},
                {},
                Eigen::MatrixXd::Zero(size, size)};
  for (Eigen::Index i = 0; i < size; ++i) {
    const LawRow& row = law.rows[static_cast<std::size_t>(i) / per_row];
    const Eigen::Index k = i % static_cast<Eigen::Index>(per_row);
    const Mat3 basis = contact_basis(row.normal);
    m.axes.row(i) = basis.col(k);
    for (Eigen::Index j = 0; j <= i; ++j) {
      m.compliance(i, j) = m.compliance(j, i) =
          law.compliance[static_cast<std::size_t>(i * (i + 1) / 2 + j)];
    }
    if (row.force.isZero(0)) continue;
    m.pressing.push_back(i);
    const bool sliding = slides(row, law.friction_coefficient);
    if (k > 0 && sliding) continue;
    const auto column = static_cast<Eigen::Index>(m.unlimited.size());
    m.forces(i, column) = 1;
    for (Eigen::Index t = 1; sliding && t < static_cast<Eigen::Index>(per_row); ++t) {
      m.forces(i + t, column) = basis.col(t).dot(row.force) / basis.col(0).dot(row.force);
    }
    m.unlimited.push_back(i);
  }
  m.forces.conservativeResize(size, static_cast<Eigen::Index>(m.unlimited.size()));
  return m;
}

/// With every row that presses held within its cone; zero where W is not regular.
Mat3 sticking_stiffness(const LawMatrices& m) {
  Eigen::MatrixXd own = m.compliance(m.pressing, m.pressing);
  own.diagonal() *= 1 + kRegular;
  const Eigen::MatrixXd motion = m.axes(m.pressing, Eigen::all);
  const Eigen::LLT<Eigen::MatrixXd> factor(own);
  if (factor.info() != Eigen::Success) return Mat3::Zero();
  return motion.transpose() * factor.solve(motion);
}

/// With those on their cone sliding; their friction makes it unsymmetric.
Mat3 sliding_stiffness(const LawMatrices& m) {
  Eigen::MatrixXd answers = (m.compliance * m.forces)(m.unlimited, Eigen::all);
  answers.diagonal() *= 1 + kRegular;
  const Eigen::MatrixXd motion = m.axes(m.unlimited, Eigen::all);
  return m.axes.transpose() * m.forces * answers.partialPivLu().solve(motion);
}

}  // namespace

// Pressed by d, a row that sticks answers with forces of W⁻¹. Does its friction need less than μ
// times what its normal force grows by, it sticks whatever friction it had; and only there would
// sliding, which adds all of μ, be the stiffer: one row gives 1/(W_nn + μ W_nd) against
// 1/(W_nn − W_nd²/W_dd). So no force along a normal grows faster than that of rows that stick, and
// none falls as it is pressed: a row alone gives a k n (n + μ d)ᵀ, no less than −μ k/2 either way.
RowStiffness stiffness_of(const LocalLaw& law) {
  const LawMatrices m = matrices_of(law);
  if (m.pressing.empty()) return {};
  const Mat3 sticking = sticking_stiffness(m);
  // Of a bad state's W.
  if (!sticking.allFinite() || sticking.isZero(0)) return {Mat3::Zero(), true};
  if (m.unlimited.size() == m.pressing.size()) return {sticking, false};
  Mat3 stiffness = sliding_stiffness(m);
  const double most = kRounding * std::hypot(1, law.friction_coefficient) * sticking.operatorNorm();
  if (!stiffness.allFinite() || stiffness.operatorNorm() > most) return {sticking, true};
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(0.5 * (stiffness + stiffness.transpose()),
                                                   Eigen::EigenvaluesOnly);
  if (solver.eigenvalues()[0] < -0.5 * law.friction_coefficient * most) return {sticking, true};
  // The forces on a round probe turn as it slides over the tissue.
  for (const LawRow& row : law.rows) {
    if (row.radius == 0 || !slides(row, law.friction_coefficient)) continue;
    const double force = row.normal.dot(row.force);
    stiffness -= force / row.radius * (Mat3::Identity() - row.normal * row.normal.transpose());
  }
  return {0.5 * (stiffness + stiffness.transpose()), false};
}

}  // namespace palpate::deformation
