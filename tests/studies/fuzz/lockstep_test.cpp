#include "studies/fuzz/lockstep.h"

#include <catch2/catch.hpp>

#include "tests/studies/fuzz/stores.h"

namespace palpate::fuzz {
namespace {

TEST_CASE("lockstep: the same scene ends the same way, refusals say why") {
  // Oracle: determinism; the message of the layer that refuses.
  RandomScene scene = random_scene(6, 1);
  const Outcome first = run_lockstep(scene, testing::shapes());
  const Outcome again = run_lockstep(scene, testing::shapes());
  CHECK(first.guards == again.guards);
  CHECK(first.time == again.time);
  CHECK(first.what == again.what);
  scene.scene.organs[0].fixed = {scene::SphereRegion{scene.scene.organs[0].pose.position, 5}};
  const Outcome refused = run_lockstep(scene, testing::shapes());
  CHECK(refused.ending == Ending::kRefused);
  CHECK_THAT(refused.what, Catch::Contains("every one of its"));
}

}  // namespace
}  // namespace palpate::fuzz
