#include "palpate/scene_file.h"

#include <catch2/catch.hpp>

#include "tests/palpate/ball_scene.h"

using namespace palpate::launcher;

TEST_CASE("scene file: a file goes before a name, what is neither is refused, a mesh sent on") {
  // Oracle: definition.
  const palpate::testing::BallScene scene;
  CHECK(scene_file(scene.file()) == scene.file());
  CHECK_THROWS_WITH(scene_file("/nowhere/x.yaml"),
                    Catch::Contains("/nowhere/x.yaml: no such file"));
  CHECK_THROWS_WITH(scene_file("stomach_prob"), Catch::Contains("palpate list scenes"));
  CHECK_THROWS_WITH(scene_file(scene.folder() / "ball.ply"), Catch::Contains("palpate new"));
  CHECK(scene_file("").empty());
}
