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
