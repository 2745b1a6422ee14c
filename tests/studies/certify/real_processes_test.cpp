#include "studies/certify/real_processes.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <sstream>

#include "tests/modules/runtime/own_bus.h"
#include "tests/studies/certify/subjects.h"

using namespace palpate;
using namespace palpate::testing;
using namespace palpate::certify;

TEST_CASE("certify processes: of a certificate's parts over DDS only those wanted are measured") {
  // Oracle: definition of `only`; a push that the ball holds leaves its device at rest on it.
  const BallScene scene(kFingerFromAbove);
  const Subject subject = load_subject(scene.file(), kGoOn);
  CertifyOptions options;
  options.out = scene.folder();
  options.only = {"held"};
  options.bus = own_bus_options();
  std::vector<Line> lines;
  std::ostringstream log;
  const auto add = [&](const std::vector<Line>& more) {
    lines.insert(lines.end(), more.begin(), more.end());
  };
  measure_real_processes({options, subject, 0.04, kGoOn, add, log});

  REQUIRE(lines.size() == 2);
  for (const Line& line : lines) {
    INFO(line.name);
    CHECK(line.group == "over DDS");
    CHECK(line.verdict != Verdict::kNotMeasured);
  }
  CHECK(log.str() == "held over DDS …\n");
}
