#include "studies/chart/fidelity.h"

#include <catch2/catch.hpp>
#include <set>

#include "tests/modules/geometry/tetrahedra.h"

namespace palpate::chart {
namespace {

TEST_CASE("fidelity: each is there once, and settings have names of their own") {
  // Oracle: counting.
  const auto models = model_hierarchy();
  CHECK(std::set(models.begin(), models.end()).size() == models.size());
  CHECK(Setting{scene::Model::kCorotational, 1, 250}.name() == "corotational, level 1, 250 Hz");
  CHECK(Setting{scene::Model::kCorotational, 1, 250}.key() == "corotational-1-250");
  CHECK(Setting{scene::Model::kCorotational, 1, 250, 5}.key() == "corotational-1-250-5");
}

TEST_CASE("fidelity: a mesh becomes what the model wants") {
  // Oracle: the kinds of models.
  const auto linear = geometry::shape_of(geometry::testing::block({1, 1, 1}, 2, 2, 2));
  CHECK_FALSE(shape_for({scene::Model::kPenalty}, linear).is_solid());
  CHECK(shape_for({scene::Model::kCorotational}, linear).edge_nodes.empty());
  CHECK(shape_for({scene::Model::kModal}, linear).edge_nodes.size() == linear.tetrahedra.size());
}

}  // namespace
}  // namespace palpate::chart
