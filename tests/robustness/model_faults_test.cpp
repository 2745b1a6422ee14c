// Every model between plates that close to a tenth: which keeps its shape, which needs its guards.
#include <catch2/catch.hpp>

#include "tests/robustness/models_under_test.h"
#include "tests/robustness/witness.h"

namespace palpate::deformation {
namespace {

/// Shape a model is back to 3 s after the plates opened, over the cube root of its volume. Those
/// that keep no volume, or only that of parts, may stay folded: their walls pass each other.
double expected_shape(const std::string& model) {
  const bool may_fold = model == "mass_spring" || model == "zordan" || model == "element_volume" ||
                        model == "chainmail";
  return may_fold ? 2 : 1e-2;
}

TEST_CASE("model faults: between plates that close to a tenth no model breaks out") {
  // Oracle: invariants; the table above is what was measured.
  for (const auto& kind : testing::models_under_test()) {
    const auto organ = testing::organ_of(kind);
    const auto shape = testing::compact_shape(kind.model);
    DeformationWorld world(testing::ball_scene(2, organ), {shape});
    const auto witness = testing::squeeze_and_release(world, 0.9);
    const auto model = build_organ_model(organ, Vec3::Zero(), shape);
    UNSCOPED_INFO(testing::name_of(kind)
                  << ": shape " << witness.shape_error(model) << ", replaced "
                  << witness.story.replaced << ", to rest " << witness.story.to_rest << ", force "
                  << witness.largest_force << " N, least volume "
                  << witness.least_volume / model.rest_volume);
    CHECK(witness.finite);
    CHECK(witness.story.replaced < 20);
    CHECK(witness.shape_error(model) < expected_shape(kind.model));
  }
}

}  // namespace
}  // namespace palpate::deformation
