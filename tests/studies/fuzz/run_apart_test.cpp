#include <sys/wait.h>

#include <catch2/catch.hpp>
#include <cerrno>

#include "studies/fuzz/lockstep.h"
#include "tests/studies/fuzz/stores.h"

namespace palpate::fuzz {
namespace {

TEST_CASE("run_apart: the outcome comes back from the child, and a crash of it as a failure") {
  // Oracle: the same run in this process; a scene whose script breaks a demand (a move of no time).
  RandomScene scene = random_scene(6, 1);
  const Outcome here = run_lockstep(scene, testing::shapes());
  const Outcome apart = run_apart(scene, testing::shapes());
  CHECK(apart.guards == here.guards);
  CHECK(apart.what == here.what);
  auto& way = std::get<scene::ScriptedDevice>(scene.scene.probes[0].device);
  way.moves = {{Vec3::Zero(), 0}};
  const Outcome crashed = run_apart(scene, testing::shapes());
  CHECK(crashed.ending == Ending::kFailed);
  CHECK_THAT(crashed.what, Catch::Contains("crash") && Catch::Contains("duration > 0"));
}

TEST_CASE("run_apart: whoever wants it to end ends it, and the child with it") {
  // Oracle: the children that are left. It is asked before the child has said anything.
  struct Stop {};
  const ShapeStore& shapes = testing::shapes();
  const auto keep_going = [] { throw Stop{}; };
  CHECK_THROWS_AS(run_apart(random_scene(1, 279), shapes, keep_going), Stop);
  CHECK(::waitpid(-1, nullptr, WNOHANG) == -1);
  CHECK(errno == ECHILD);
}

}  // namespace
}  // namespace palpate::fuzz
