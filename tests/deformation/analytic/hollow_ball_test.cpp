// The shipped springs beside finite elements: a fluid-filled hollow ball and a solid one.
#include <catch2/catch.hpp>
#include <cmath>

#include "deformation/model/spring_network.h"
#include "modules/core/data_folder.h"
#include "studies/calibration/calibration.h"

namespace palpate::calibration {
namespace {

const auto kReference = data_folder() / "reference";

TEST_CASE("hollow ball: with the shipped springs it follows finite elements when squeezed") {
  // Oracle: independent tool, a finite-element solution good to 0.2 %. 10 % from 30 % compression
  // on is what the model promises; at 20 % the wall's bending, which springs lack, is worth 13 %.
  const int levels = GENERATE(3, 4);
  const auto hollow = hollow_ball(kReference);
  REQUIRE(hollow.ball.organ.springs.inner_ratio == scene::Springs{}.inner_ratio);
  REQUIRE(hollow.ball.organ.springs.bending_ratio == scene::Springs{}.bending_ratio);
  const auto comparison = compare(hollow, levels, {});
  for (std::size_t i = 0; i < hollow.rows.size(); ++i) {
    const double compression = hollow.rows[i].compression;
    if (compression < 0.2 - 1e-9) continue;
    INFO(comparison.nodes << " nodes, compression " << compression);
    const auto row = ratios(comparison.equilibria[i], hollow.rows[i], hollow.ball.outer_radius);
    const double tolerance = compression < 0.3 - 1e-9 ? 0.15 : 0.1;
    CHECK(comparison.equilibria[i].settled);
    CHECK(row.force == Approx(1).margin(tolerance));
    CHECK(*row.pressure == Approx(1).margin(tolerance));
    CHECK(row.radius == Approx(1).margin(0.005));
    CHECK(row.bulge == Approx(1).margin(tolerance));
  }
}

TEST_CASE("solid ball: with the recommended springs its force follows, its bulge lags") {
  // Oracle: independent tool, finite elements good to 0.03 %. Force within 10 % from 20 %
  // compression on. The bulge grows too little (a filled shell is not a solid): the radius is
  // checked to the 3 % that docs/calibration.md states.
  const auto solid = solid_ball(kReference);
  const auto comparison = compare(solid, 3, {});
  for (std::size_t i = 0; i < solid.rows.size(); ++i) {
    const double compression = solid.rows[i].compression;
    if (compression < 0.2 - 1e-9) continue;
    INFO("compression " << compression);
    const auto row = ratios(comparison.equilibria[i], solid.rows[i], solid.ball.outer_radius);
    CHECK(row.force == Approx(1).margin(0.1));
    CHECK(row.radius == Approx(1).margin(0.032));
  }
}

TEST_CASE("hollow ball: its equilibria do not depend on the way to them") {
  // Oracle: invariant, frictionless elastic equilibria have no memory. 0.5 %: nodes that are just
  // touching or just not.
  const auto hollow = hollow_ball(kReference);
  SqueezedBall at_once(hollow.ball, 2), in_parts(hollow.ball, 2);
  for (const double compression : {0.1, 0.25, 0.3}) in_parts.squeeze_to(compression);
  const auto a = at_once.squeeze_to(0.4), b = in_parts.squeeze_to(0.4);
  CHECK(a.force == Approx(b.force).epsilon(5e-3));
  CHECK(a.pressure == Approx(b.pressure).epsilon(5e-3));
  CHECK(a.equatorial_radius == Approx(b.equatorial_radius).epsilon(1e-3));
}

TEST_CASE("membrane factor: it lies where springs meet stretched tissue") {
  // Oracle: analytic. Nominal tension over E t at stretch λ, both directions alike: springs
  // (3/2)(λ − 1), incompressible neo-Hookean wall (λ − λ⁻⁵)/3. The factor must lie between the
  // ratios at 5 and at 20 %, the stretches of a squeezed organ.
  const auto both_ways = [](double stretch) {
    return (stretch - std::pow(stretch, -5)) / 3 / (1.5 * (stretch - 1));
  };
  CHECK(both_ways(1.0001) == Approx(4.0 / 3).epsilon(1e-3));
  CHECK(deformation::kMembraneFactor < both_ways(1.05));
  CHECK(deformation::kMembraneFactor > both_ways(1.2));
}

}  // namespace
}  // namespace palpate::calibration
