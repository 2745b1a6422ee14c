#include "deformation/materials/isochoric_neo_hookean.h"

#include <catch2/catch.hpp>

namespace palpate::deformation {

TEST_CASE("isochoric neo-Hookean: swelling costs nothing") {
  // Oracle: J^(−2/3) tr FᵀF does not change as F is scaled; rounding.
  Mat3 F;
  F << 1.2, 0.3, -0.1, 0.05, 0.8, 0.2, -0.3, 0.1, 1.1;
  const IsochoricNeoHookean law(ElasticConstants(3, 0.5));  // μ = 1 Pa
  CHECK(law.energy_density(1.3 * F) == Approx(law.energy_density(F)));
  CHECK(law.first_piola_stress(1.3 * Mat3::Identity()).norm() < 1e-14);
}

}  // namespace palpate::deformation
