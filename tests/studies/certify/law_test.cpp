#include "studies/certify/law.h"

#include <catch2/catch.hpp>

#include "tests/studies/certify/subjects.h"

using namespace palpate;
using namespace palpate::testing;
using namespace palpate::certify;

TEST_CASE("certify law: median and worst, of an organ that gives way or yields too") {
  // Oracle: definition, |law − organ|/|organ|: of −50 N/m beside 100 N/m it is 300 %; of 0 nothing
  // is within any limit.
  const auto at = [](double law, double organ) { return LawStiffness{1e-3, law, organ}; };
  const auto lines = law_lines({at(105, 100), at(92, 100), at(130, 100)});
  REQUIRE(lines.size() == 2);
  CHECK(lines[0].value == Approx(8));
  CHECK(lines[0].verdict == Verdict::kPass);
  CHECK(lines[1].value == Approx(30));
  CHECK(lines[1].verdict == Verdict::kFail);
  const auto yielding = law_lines({at(105, 100), at(100, -50), at(92, 100)});
  CHECK(yielding[0].value == Approx(8));
  CHECK(yielding[1].value == Approx(300));
  const auto none = law_lines({at(105, 100), at(0, 0), at(92, 100)});
  CHECK(none[0].value == Approx(8));
  CHECK(none[0].verdict == Verdict::kPass);
  CHECK(none[1].verdict == Verdict::kFail);
}

TEST_CASE("certify law: it finds the stiffness of a ball") {
  // Oracle: finite differences of the organ itself, which the law's derivation keeps to within 20 %
  // on a ball of springs (docs/numerics.md).
  const BallScene scene(kFingerFromAbove);
  Subject subject = load_subject(scene.file(), kGoOn);
  subject.depth = 3e-3;
  ContactTroubles troubles;
  const auto found = measure_law(subject, kGoOn, troubles);
  REQUIRE(found.size() == 6);
  for (const LawStiffness& point : found) CHECK(point.organ > 0);
  CHECK(found.back().depth == Approx(4e-3));
  CHECK(found.back().law / found.back().organ == Approx(1).margin(0.2));
}
