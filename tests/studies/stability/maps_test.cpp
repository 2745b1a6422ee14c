#include "studies/stability/maps.h"

#include <catch2/catch.hpp>
#include <set>

namespace palpate::stability {
namespace {

TEST_CASE("maps: each has a name, rising values, and less of everything when quick") {
  // Oracle: what the header promises.
  const auto quick = maps(true), usual = maps(false);
  REQUIRE(quick.size() == usual.size());
  std::set<std::string> names;
  for (std::size_t i = 0; i < quick.size(); ++i) {
    INFO(quick[i].name);
    CHECK(names.insert(quick[i].name).second);
    CHECK(std::string(quick[i].name) == usual[i].name);
    CHECK(quick[i].xs.size() < usual[i].xs.size());
    CHECK(quick[i].ys.size() < usual[i].ys.size());
    CHECK(quick[i].series.size() < usual[i].series.size());
    CHECK(quick[i].precision > usual[i].precision);
    for (const Map* map : {&quick[i], &usual[i]}) {
      CHECK(std::is_sorted(map->xs.begin(), map->xs.end()));
      CHECK(std::is_sorted(map->ys.begin(), map->ys.end()));
      CHECK(map->ys.front() > 0);
    }
  }
}

TEST_CASE("maps: the prediction of a squeezed ball is of the ball as it is squeezed") {
  // Oracle: stretched springs are stiffer across than those at rest.
  for (const Map& map : maps(true)) {
    if (std::string(map.name) != "squeeze") continue;
    const double rest = map.predict("implicit_volume", 0).value;
    const double squeezed = map.predict("implicit_volume", 0.6).value;
    CHECK(squeezed < rest);
    CHECK(squeezed > 0.5 * rest);
  }
}

}  // namespace
}  // namespace palpate::stability
