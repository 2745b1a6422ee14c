#include "deformation/steppers/modal_analysis.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>

#include "deformation/steppers/quasi_static_newton.h"

namespace palpate::deformation {
namespace {

constexpr int kMostIterations = 100;
constexpr double kTolerance = 1e-8;

/// Fixed numbers that belong to no symmetry: a start that has something of every mode.
Eigen::MatrixXd start_vectors(Eigen::Index rows, Eigen::Index columns) {
  Eigen::MatrixXd x(rows, columns);
  std::uint64_t state = 1;
  for (Eigen::Index j = 0; j < columns; ++j) {
    for (Eigen::Index i = 0; i < rows; ++i) {
      state = state * 6364136223846793005ULL + 1442695040888963407ULL;  // Knuth's MMIX
      x(i, j) = static_cast<double>(state >> 11) * 0x1p-53 - 0.5;
    }
  }
  return x;
}

class MassOperator {
 public:
  MassOperator(const TaylorHoodElements& solid, const std::vector<char>& constrained)
      : solid_(solid), constrained_(constrained) {
    for (std::size_t e = 0; e < solid.element_count(); ++e) masses_.push_back(solid.mass(e));
  }

  /// M x for every column; zero for pressures and constrained coordinates.  (dof_count × any)
  Eigen::MatrixXd operator*(const Eigen::MatrixXd& x) const {
    Eigen::MatrixXd y = Eigen::MatrixXd::Zero(x.rows(), x.cols());
    for (std::size_t e = 0; e < masses_.size(); ++e) {
      const auto& nodes = solid_.mesh().elements[e];
      for (int i = 0; i < 3; ++i) {
        std::array<Eigen::Index, kElementNodes> rows{};
        for (int a = 0; a < kElementNodes; ++a) rows[a] = 3 * nodes[a] + i;
        y(rows, Eigen::all) += masses_[e] * x(rows, Eigen::all);
      }
    }
    for (std::size_t i = 0; i < constrained_.size(); ++i) {
      if (constrained_[i]) y.row(static_cast<Eigen::Index>(i)).setZero();
    }
    return y;
  }

 private:
  const TaylorHoodElements& solid_;
  const std::vector<char>& constrained_;
  std::vector<ElementMass> masses_;
};

}  // namespace

// With K̂ + s M factored: X = (K̂ + s M)⁻¹ M Y. Ritz values θ of (XᵀMY, XᵀMX) are ω² + s.
Eigenmodes modal_analysis(const TaylorHoodElements& solid, const std::vector<char>& constrained,
                          std::size_t count, const std::function<void()>& keep_going) {
  const MassOperator mass(solid, constrained);
  // A shear wave across the body gives the order of ω²; the shift makes a free body's K̂ regular.
  const double wave_speed_squared = solid.tissue().shear_modulus() / solid.density();
  const double shift = wave_speed_squared / (solid.size() * solid.size());
  QuasiStaticNewton solver(solid, constrained, nullptr);
  const SolidState rest = solid.rest_state();
  if (!solver.factor(rest, Inertia{shift, rest.positions}, false, keep_going)) {
    throw std::runtime_error("modal analysis: the stiffness matrix is singular");
  }
  const auto wanted = static_cast<Eigen::Index>(count);
  const Eigen::Index vectors = std::max(wanted + 8, 3 * wanted / 2);
  Eigen::MatrixXd y = mass * start_vectors(static_cast<Eigen::Index>(solid.dof_count()), vectors);
  Eigen::VectorXd earlier = Eigen::VectorXd::Zero(vectors);
  for (int iteration = 0; iteration < kMostIterations; ++iteration) {
    keep_going();
    Eigen::MatrixXd x = y;  // y = M Y
    solver.factorisation().solve(x);
    const Eigen::MatrixXd mass_x = mass * x;
    const Eigen::MatrixXd projected = x.transpose() * y, metric = x.transpose() * mass_x;
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> ritz(
        (projected + projected.transpose()) / 2, (metric + metric.transpose()) / 2);
    const Eigen::VectorXd values = ritz.eigenvalues();
    y = mass_x * ritz.eigenvectors();
    const double change = (values - earlier).head(wanted).cwiseAbs().maxCoeff();
    earlier = values;
    if (change > kTolerance * values[wanted - 1]) continue;
    Eigenmodes result;
    for (Eigen::Index k = 0; k < wanted; ++k) {
      result.angular_frequencies.push_back(std::sqrt(std::max(0.0, values[k] - shift)));
    }
    const Eigen::MatrixXd solutions = x * ritz.eigenvectors().leftCols(wanted);
    const auto displacements = static_cast<Eigen::Index>(solid.displacement_count());
    result.modes = solutions.topRows(displacements);
    result.momenta = (mass * solutions).topRows(displacements);
    result.pressures = solutions.bottomRows(solutions.rows() - displacements);
    return result;
  }
  throw std::runtime_error("modal analysis: not converged after " +
                           std::to_string(kMostIterations) + " iterations");
}

}  // namespace palpate::deformation
