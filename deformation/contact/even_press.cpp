#include "deformation/contact/even_press.h"

#include <vector>

namespace palpate::deformation {

double even_press_compliance(const PressedPatch& patch, double period, int steps) {
  const double h = period / steps;
  const Eigen::Index size = patch.push.size();
  const Eigen::VectorXd volume_answers = patch.volume.cwiseQuotient(patch.masses);
  const double denominator = patch.volume_beyond + patch.volume.dot(volume_answers);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(size), v = x, forces = patch.push;
  double beyond = 0;  // velocities there are this times M⁻¹g
  std::vector<double> answers, needed;
  double sum = 0;
  for (int j = 1; j <= steps; ++j) {
    if (j > 1) {
      const Eigen::VectorXf at = x.cast<float>(), moving = v.cast<float>();
      forces = -(patch.stiffness.selfadjointView<Eigen::Lower>() * at +
                 patch.damping.selfadjointView<Eigen::Lower>() * moving)
                    .cast<double>();
    }
    v += h * (forces.cwiseQuotient(patch.masses) - patch.drag * v);
    beyond -= h * patch.drag * beyond;
    if (denominator > 0) {
      const double sigma = (patch.volume.dot(v) + beyond * patch.volume_beyond) / denominator;
      v -= sigma * volume_answers;
      beyond -= sigma;
    }
    x += h * v;
    answers.push_back(patch.push.dot(x));
    double missing = static_cast<double>(j) / steps;
    for (std::size_t i = 0; i < needed.size(); ++i) {
      missing -= answers[needed.size() - i] * needed[i];
    }
    needed.push_back(missing / answers[0]);
    sum += needed.back();
  }
  return steps / sum;
}

}  // namespace palpate::deformation
