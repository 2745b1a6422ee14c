#include "deformation/materials/elastic_constants.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "modules/core/error.h"

namespace palpate::deformation {

TEST_CASE("elastic constants: all follow from Young's modulus and Poisson's ratio") {
  // Oracle: textbook relations E = 9κμ/(3κ+μ), κ = λ + 2μ/3, ν = λ/(2(λ+μ)); E = 280 Pa, ν = 0.4
  // gives μ = 100 Pa, λ = 400 Pa by hand.
  const ElasticConstants tissue(280, 0.4);
  const double mu = tissue.shear_modulus(), lambda = tissue.lame_lambda();
  const double kappa = 1 / tissue.inverse_bulk_modulus();
  CHECK(mu == Approx(100));
  CHECK(lambda == Approx(400));
  CHECK(9 * kappa * mu / (3 * kappa + mu) == Approx(280));
  CHECK(kappa == Approx(lambda + 2 * mu / 3));
  CHECK(lambda / (2 * (lambda + mu)) == Approx(0.4));
  CHECK(tissue.lambda_over_shear() == Approx(lambda / mu));
  CHECK(tissue.bulk_over_shear() == Approx(kappa / mu));
}

TEST_CASE("elastic constants: incompressible tissue has no inverse bulk modulus") {
  // Oracle: the limit ν → 1/2.
  const ElasticConstants tissue(5000, 0.5);
  CHECK(tissue.inverse_bulk_modulus() == 0);
  CHECK(std::isinf(tissue.lame_lambda()));
  CHECK(std::isinf(tissue.bulk_over_shear()));
}

TEST_CASE("elastic constants: others are refused, with what is allowed") {
  // Oracle: the stated ranges.
  CHECK_THROWS_WITH(ElasticConstants(5000, 0.51),
                    Catch::Contains("0.51") && Catch::Contains("allowed: 0 to 0.5"));
  CHECK_THROWS_AS(ElasticConstants(5000, -0.1), InputError);
  CHECK_THROWS_AS(ElasticConstants(0, 0.3), InputError);
  CHECK_THROWS_AS(ElasticConstants(INFINITY, 0.3), InputError);
}

}  // namespace palpate::deformation
