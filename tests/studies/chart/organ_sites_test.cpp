#include "studies/chart/organ_sites.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "deformation/model/organ_model.h"
#include "modules/geometry/winding_number.h"
#include "tests/modules/geometry/tetrahedra.h"
#include "tests/studies/keep_on.h"

namespace palpate::chart {
namespace {

using report::kKeepOn;

TEST_CASE("organ sites: a seed gives the same places, on the skin, away from what is fixed") {
  // Oracle: the stated rules.
  if (geometry::testing::without_gmsh()) return;
  const OrganSites sites(rigs::kOnStomach, 8e-3);
  const auto places = sites.random(6, 1), more = sites.random(8, 1), others = sites.random(6, 2);
  REQUIRE(places.size() == 6);
  const auto& skin = sites.surface();
  const auto organ = rigs::poked_organ(rigs::kOnStomach);
  for (std::size_t i = 0; i < places.size(); ++i) {
    CHECK(places[i].touched == more[i].touched);
    CHECK(places[i].touched != others[i].touched);
    CHECK(places[i].into.norm() == Approx(1));
    for (const auto& [depth, inside] : {std::pair{-1e-3, false}, {1e-3, true}, {20e-3, true}}) {
      const Vec3 x = places[i].touched + depth * places[i].into;
      CHECK((geometry::winding_number(x, skin.nodes, skin.triangles) > 0.5) == inside);
    }
    for (const Vec3& node : skin.nodes) {
      if (!deformation::is_fixed(organ, node)) continue;
      CHECK((node - places[i].touched).norm() >= 15e-3);
    }
  }
}

TEST_CASE("organ sites: a press that follows is as one that was refined in advance, and softer") {
  // Oracle: the same edges under the tip, so forces alike (5 %, for sizes differ further away);
  // the mesh as shipped is far too hard (docs/accuracy.md). Skin that is pressed in goes in.
  if (geometry::testing::without_gmsh()) return;
  const OrganSites sites(rigs::kOnLiver, 8e-3);
  const Site site = sites.random(1, 1)[0];
  const auto press = [&](Small small) {
    return sites.press(site, {"nodal_pressure", 0, 100, 0, small}, kKeepOn);
  };
  const auto shipped = press(Small::kNowhere), near = press(Small::kAtPlaces),
             following = press(Small::kFollowing);
  REQUIRE(following.samples.size() == kSiteDepths.size());
  for (std::size_t i = 0; i < kSiteDepths.size(); ++i) {
    CHECK(following.samples[i].load == kSiteDepths[i]);
    CHECK(following.samples[i].force == Approx(near.samples[i].force).epsilon(0.05));
    CHECK(following.samples[i].force < 0.9 * shipped.samples[i].force);
    CHECK(following.samples[i].profile[0] < 0);
    CHECK(following.samples[i].estimated_error > 0);
  }
  CHECK(following.inner_nodes + following.surface_nodes >
        2 * (shipped.inner_nodes + shipped.surface_nodes));
  CHECK(following.troubled_places == 0);
}

TEST_CASE("organ sites: many places make one measurement of medians, place by place") {
  // Oracle: by hand.
  std::vector<Measurement> places(3);
  const std::array costs{0.3, 0.1, 0.2};
  for (std::size_t i = 0; i < places.size(); ++i) {
    places[i].cost = costs[i];
    places[i].inner_nodes = 10 * i;
    places[i].volume_error = costs[i];
    places[i].troubled_places = i == 1 ? 1 : 0;
    places[i].samples = {{.load = 3e-3, .force = 1.0 * static_cast<double>(i)}};
  }
  const auto all = joined(places);
  CHECK(all.cost == 0.2);
  CHECK(all.inner_nodes == 10);
  CHECK(all.volume_error == 0.3);
  CHECK(all.troubled_places == 1);
  REQUIRE(all.samples.size() == 3);
  for (std::size_t i = 0; i < all.samples.size(); ++i) {
    CHECK(all.samples[i].place == static_cast<double>(i));
    CHECK(all.samples[i].force == static_cast<double>(i));
  }
}

}  // namespace
}  // namespace palpate::chart
