#include "deformation/organ_dynamics.h"

#include <catch2/catch.hpp>

#include "tests/deformation/organs.h"

namespace palpate::deformation {
namespace {

TEST_CASE("organ dynamics: its largest step is below the stable bound and stays sound") {
  // Oracle: stable_step_bound(), tested against eigenvalues in organ_model_test.
  const auto organ = testing::ball_organ();
  const auto model = testing::ball_model(2, organ);
  const auto dynamics = make_dynamics(organ, model);
  CHECK(dynamics->largest_step() > 0.5 * stable_step_bound(model));
  CHECK(dynamics->largest_step() < stable_step_bound(model));
}

}  // namespace
}  // namespace palpate::deformation
