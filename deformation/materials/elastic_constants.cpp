#include "deformation/materials/elastic_constants.h"

#include <cmath>
#include <string>

#include "modules/core/error.h"

namespace palpate::deformation {

ElasticConstants::ElasticConstants(double youngs_modulus, double poisson_ratio)
    : E_(youngs_modulus), nu_(poisson_ratio) {
  if (!(youngs_modulus > 0) || !std::isfinite(youngs_modulus)) {
    throw InputError("Young's modulus " + std::to_string(youngs_modulus) +
                     " Pa; allowed: greater than 0");
  }
  if (!(poisson_ratio >= 0 && poisson_ratio <= 0.5)) {
    throw InputError("Poisson's ratio " + std::to_string(poisson_ratio) + "; allowed: 0 to 0.5");
  }
}

}  // namespace palpate::deformation
