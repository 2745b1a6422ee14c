#include "deformation/contact/patch_compliance.h"

#include <Eigen/Cholesky>

namespace palpate::deformation {
namespace {

struct Shares {
  double mass, damping, stiffness;
};

Shares shares_of(const PeriodSteps& steps, double drag) {
  const double T = steps.period;
  return {(1 + T * drag * steps.moving()) / (T * T), steps.moving() / T, steps.displaced()};
}

}  // namespace

PatchCompliance::PatchCompliance(const Body& body, Neighbours neighbours, std::size_t nodes)
    : body_(body), neighbours_(std::move(neighbours)), most_nodes_(nodes) {}

Eigen::MatrixXd PatchCompliance::solve(const std::vector<Vec3>& positions,
                                       std::span<const ComplianceRow> rows,
                                       const PeriodSteps& steps, std::span<const Vec3> gradient,
                                       const AddStiffness& add_stiffness) {
  std::vector<std::uint32_t> touched;
  Vec3 centre = Vec3::Zero();
  double total = 0;
  for (const ComplianceRow& row : rows) {
    for (const auto& [node, weight] : row.weights) {
      if (weight == 0) continue;
      touched.push_back(node);
      centre += weight * positions[node];
      total += weight;
    }
  }
  centre /= total;
  grow_patch(body_, neighbours_, positions, touched, centre, most_nodes_, patch_);

  const Shares shares = shares_of(steps, body_.drag);
  const auto size = static_cast<Eigen::Index>(3 * patch_.nodes.size());
  const auto count = static_cast<Eigen::Index>(rows.size());
  Eigen::MatrixXf A = Eigen::MatrixXf::Zero(size, size);
  if (shares.stiffness > 0) add_stiffness(patch_, shares.stiffness, shares.damping, A);
  // A column a row of C, and one for the volume.
  Eigen::MatrixXf loads = Eigen::MatrixXf::Zero(size, count + 1);
  for (const std::uint32_t node : patch_.nodes) {
    const Eigen::Index at = 3 * patch_.place(node);
    A.diagonal().segment<3>(at).array() += static_cast<float>(shares.mass * body_.masses[node]);
    if (node < gradient.size()) loads.col(count).segment<3>(at) = gradient[node].cast<float>();
  }
  Eigen::MatrixXd alone = Eigen::MatrixXd::Zero(count, count);
  for (Eigen::Index r = 0; r < count; ++r) {
    const ComplianceRow& row = rows[static_cast<std::size_t>(r)];
    for (const auto& [node, weight] : row.weights) {
      const int place = patch_.place(node);
      if (place >= 0) {
        loads.col(r).segment<3>(3 * place) += (weight * row.axis).cast<float>();
      } else {
        alone(r, r) += weight * weight * body_.inverse_masses[node] / shares.mass;
      }
    }
  }
  const Eigen::LLT<Eigen::MatrixXf> factor(A);
  if (factor.info() != Eigen::Success)
    return Eigen::MatrixXd::Zero(count, count);  // no law from a bad state
  // W = (L⁻¹Cᵀ)ᵀ(L⁻¹Cᵀ): symmetric and positive however it is rounded.
  const Eigen::MatrixXd half = factor.matrixL().solve(loads).cast<double>();
  Eigen::MatrixXd answers = half.leftCols(count).transpose() * half.leftCols(count) + alone;
  if (gradient.empty()) return answers;

  double inverse_mass = half.col(count).squaredNorm();  // gᵀA⁻¹g
  for (std::size_t i = 0; i < gradient.size(); ++i) {
    if (patch_.place(static_cast<std::uint32_t>(i)) < 0) {
      inverse_mass += gradient[i].squaredNorm() * body_.inverse_masses[i] / shares.mass;
    }
  }
  if (!(inverse_mass > 0)) return answers;
  const Eigen::VectorXd shares_of_volume = half.leftCols(count).transpose() * half.col(count);
  return answers - shares_of_volume * shares_of_volume.transpose() / inverse_mass;
}

}  // namespace palpate::deformation
