#include "studies/certify/still_force.h"

#include <catch2/catch.hpp>

#include "studies/certify/disturbance.h"
#include "tests/studies/certify/subjects.h"

using namespace palpate;
using namespace palpate::testing;
using namespace palpate::certify;

TEST_CASE("certify force: what is held is felt as the organ says, unless its laws come too late") {
  // Oracle: the organ alone at the same places. With laws 90 ms late the force has faded to a fifth
  // (stale_after_s and fade_time_s of 50 ms): the line must fail.
  const BallScene scene(kFingerFromAbove);
  const Subject subject = load_subject(scene.file(), kGoOn);
  const Loop loop = loop_on_organ(subject);
  const Line sound = still_force_line(measure_still_force(loop, subject, kGoOn));
  INFO(text_of(sound) << ' ' << sound.note);
  CHECK(sound.verdict == Verdict::kPass);
  const Loop late = disturbed(loop, {0.09, 0, 0});
  const Line faded = still_force_line(measure_still_force(late, subject, kGoOn));
  INFO(text_of(faded) << ' ' << faded.note);
  CHECK(faded.verdict == Verdict::kFail);
}

TEST_CASE("certify force: where nothing pushes, nothing was judged") {
  // Oracle: forces under the least that is judged by its share; a single one that reaches it is.
  const std::vector<StillForce> none{{1e-3, 0.001, 0}, {2e-3, 0, 0.002}, {3e-3, 0.004, 0.003}};
  const Line line = still_force_line(none);
  CHECK(line.verdict == Verdict::kNotMeasured);
  CHECK(line.note.find("nothing to judge") == 0);
  std::vector<StillForce> one = none;
  one[2].organ = 0.02;
  CHECK(still_force_line(one).verdict == Verdict::kFail);
  one[2].felt = 0.02;
  CHECK(still_force_line(one).verdict != Verdict::kNotMeasured);
}
