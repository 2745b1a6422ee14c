#include "deformation/volume/rules/explicit_step.h"

#include <cmath>

namespace palpate::deformation {

double largest_explicit_step(const OrganModel& model, double added_squared_frequency) {
  // The springs' bound h₀ is the root of ω² h² + 2 d h = 4 with the organ's ω² and d.
  const double springs_alone = stable_step_bound(model);
  const double squared = highest_squared_frequency_bound(model);
  const double d = (4 - squared * springs_alone * springs_alone) / (2 * springs_alone);
  const double sum = squared + added_squared_frequency;
  return kExplicitStepSafety * (std::sqrt(d * d + 4 * sum) - d) / sum;
}

void add_along_gradient(const Body& body, const std::vector<Vec3>& gradient, double scale,
                        std::vector<Vec3>& out) {
  for (std::size_t i = 0; i < gradient.size(); ++i) {
    out[i] += (scale * body.inverse_masses[i]) * gradient[i];
  }
}

bool has_vanished(const Body& body, const VolumeGradient& volume) {
  return !(volume.denominator > kVanishedDenominator * body.rest_denominator);
}

}  // namespace palpate::deformation
