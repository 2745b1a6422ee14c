#include "studies/chart/fidelity.h"

#include <catch2/catch.hpp>
#include <fstream>
#include <iterator>
#include <set>

#include "modules/scene/models.h"
#include "tests/modules/geometry/tetrahedra.h"

namespace palpate::chart {
namespace {

TEST_CASE("fidelity: each is there once, and settings have names of their own") {
  // Oracle: counting.
  const auto models = model_hierarchy();
  CHECK(std::set(models.begin(), models.end()).size() == models.size());
  CHECK(Setting{"corotational", 1, 250}.name() == "corotational, level 1, 250 Hz");
  CHECK(Setting{"corotational", 1, 250}.key() == "corotational-1-250");
  CHECK(Setting{"corotational", 1, 250, 5}.key() == "corotational-1-250-5");
}

TEST_CASE("fidelity: the plots know every model charted, and its own number of iterations") {
  // Oracle: the table of models.
  std::ifstream file(PALPATE_SOURCE_DIR "/scripts/plots/plot_accuracy.py");
  REQUIRE(file);
  const std::string script(std::istreambuf_iterator<char>(file), {});
  std::string iterations;
  for (const std::string& model : model_hierarchy()) {
    CHECK(script.find("\n    \"" + model + "\": \"#") != std::string::npos);
    const std::size_t own = scene::format_of(model).iterations;
    if (own == 0) continue;
    iterations += (iterations.empty() ? "" : ", ") + ('"' + model + "\": " + std::to_string(own));
  }
  CHECK(script.find("OWN_ITERATIONS = {" + iterations + "}") != std::string::npos);
}

TEST_CASE("fidelity: a mesh becomes what the model wants") {
  // Oracle: the kinds of models.
  const auto linear = geometry::shape_of(geometry::testing::block({1, 1, 1}, 2, 2, 2));
  CHECK_FALSE(shape_for({"penalty"}, linear).is_solid());
  CHECK(shape_for({"corotational"}, linear).edge_nodes.empty());
  CHECK(shape_for({"modal"}, linear).edge_nodes.size() == linear.tetrahedra.size());
}

}  // namespace
}  // namespace palpate::chart
