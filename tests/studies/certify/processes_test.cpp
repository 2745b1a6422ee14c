#include "studies/certify/processes.h"

#include <catch2/catch.hpp>

#include "studies/certify/hands.h"
#include "studies/certify/release.h"
#include "studies/certify/timing.h"
#include "studies/report/measures.h"
#include "tests/modules/runtime/own_bus.h"
#include "tests/studies/certify/subjects.h"

using namespace palpate;
using namespace palpate::testing;
using namespace palpate::certify;

TEST_CASE("certify processes: pressed over DDS, timed, and let go by whatever falls silent") {
  // Oracle: invariants: a pose is answered after it was written, periods are of one clock, and
  // whatever falls silent lets go (tests/fault/released_test.cpp holds the times).
  const BallScene scene(kFingerFromAbove);
  const Subject subject = load_subject(scene.file(), kGoOn);
  Processes processes(subject, own_bus_options(), scene.folder(), kGoOn);
  REQUIRE(processes.start());
  processes.hold(firm_hand(subject.device, subject.place,
                           {{pose_below(subject.place, subject.depth).position, 0.3}}));
  REQUIRE(processes.wait(
      [&](const Heard& heard) {
        return heard.force.force.norm() > 0.01 && heard.held.back().depth > subject.depth / 2;
      },
      20));

  const Timing timing = measure_timing(processes, 1);
  REQUIRE(timing.periods.size() > 100);
  REQUIRE(timing.latencies.size() > 100);
  CHECK(report::quantile(timing.latencies, 0.01) > 0);
  CHECK(report::quantile(timing.periods, 0.5) == Approx(1e-3).epsilon(0.5));

  int told = 0;
  const auto releases = measure_releases(processes, 0.005, 1, [&](const Release& release) {
    INFO(release.who << " took " << release.took);
    CHECK(release.came);
    CHECK(release.back);
    ++told;
  });
  CHECK(told == 7);
  CHECK(releases.size() == 7);
}
