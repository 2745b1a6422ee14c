#include "deformation/contact/closing_rows.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "deformation/contact/compliance_row.h"

namespace palpate::deformation {

double stiffer_by_closing(const LawRow& row, const Vec3& went, double period, int steps) {
  const double way = row.normal.dot(period * row.velocity - went);  // towards each other
  if (steps < 2 || !(row.gap > 0 && row.gap < way)) return 1;
  const double shortest = row.gap * steps / ((steps - 1) * way);  // that meets it before the last
  const double late = std::clamp((shortest - (1 - kWay)) / (2 * kWay), 0.0, 1.0);
  return 1 + (steps - 1) * late;
}

// W = L Lᵀ; the columns of L are what rows give way by themselves. So W stays positive.
void stiffen_closing_rows(std::span<const double> stiffer, Eigen::MatrixXd& W) {
  if (std::ranges::all_of(stiffer, [](double by) { return by == 1; })) return;
  Eigen::MatrixXd regular = W;
  regular.diagonal() *= 1 + kRegular;
  const Eigen::LLT<Eigen::MatrixXd> factor(regular);
  if (factor.info() != Eigen::Success) return;
  Eigen::MatrixXd L = factor.matrixL();
  const auto per_row = W.rows() / static_cast<Eigen::Index>(stiffer.size());
  for (std::size_t r = 0; r < stiffer.size(); ++r) {
    L.middleCols(static_cast<Eigen::Index>(r) * per_row, per_row) /= std::sqrt(stiffer[r]);
  }
  W = L * L.transpose();
}

}  // namespace palpate::deformation
