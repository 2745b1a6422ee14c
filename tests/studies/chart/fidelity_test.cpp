#include "studies/chart/fidelity.h"

#include <catch2/catch.hpp>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>

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
  Setting follows{"nodal_pressure", 0, 100, 0, Small::kFollowing};
  CHECK(follows.name() == "nodal_pressure, level 0 following, 100 Hz");
  CHECK(follows.key() == "nodal_pressure-0-100-follow");
  follows.places = 8;
  CHECK(follows.key() == "nodal_pressure-0-100-follow-8places");
}

TEST_CASE("fidelity: the page's table of models names every model charted, once") {
  // Oracle: the table of models.
  std::ifstream file(PALPATE_SOURCE_DIR "/docs/accuracy.md");
  REQUIRE(file);
  const std::string page(std::istreambuf_iterator<char>(file), {});
  const std::size_t begin = page.find("## Models"), end = page.find("## Cases");
  REQUIRE(begin < end);
  std::multiset<std::string> named;
  std::istringstream rows(page.substr(begin, end - begin));
  for (std::string row; std::getline(rows, row);) {
    if (!row.starts_with("| ")) continue;
    std::istringstream words(row.substr(2, row.find(" |") - 2));
    for (std::string word; words >> word;) named.insert(word.substr(0, word.find(',')));
  }
  named.erase("`model:`");
  const auto models = model_hierarchy();
  CHECK(named == std::multiset<std::string>(models.begin(), models.end()));
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
