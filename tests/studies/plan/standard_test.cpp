#include "studies/plan/standard.h"

#include <catch2/catch.hpp>

#include "modules/core/error.h"
#include "modules/scene/scene_file.h"
#include "modules/scene/scene_reader.h"

namespace palpate::plan {
namespace {

TEST_CASE(
    "standard: a truth judges solids, and walls under round probes if force or surface counts") {
  // Oracle: the definition.
  CHECK(is_judged_by_truth(scene::load_scene(scene::scene_file("liver_solid"))));
  const scene::Scene wall = scene::load_scene(scene::scene_file("stomach_probe"));
  CHECK(is_judged_by_truth(wall));
  scene::Scene boxed = wall;
  boxed.probes[0].shape = scene::BoxShape{};
  CHECK_FALSE(is_judged_by_truth(boxed));
  scene::Scene volume_alone = wall;
  volume_alone.needs.force_error.reset();
  CHECK(is_judged_by_truth(volume_alone));
  volume_alone.needs.surface_error.reset();
  CHECK_FALSE(is_judged_by_truth(volume_alone));
}

TEST_CASE("standard: where no probe touches, nothing is judged by touches") {
  // Oracle: the scene's probe comes to the organ after some 2.5 s.
  const scene::Scene wall = scene::load_scene(scene::scene_file("stomach_probe"));
  PlanOptions options;
  options.seconds = 1;
  CHECK_THROWS_WITH(Standard(wall, options),
                    Catch::Contains("no probe touches the organ in the first 1 s"));
  options.seconds = 3;
  const Standard standard(wall, options);
  CHECK(standard.radius() == Approx(0.008));
  CHECK(standard.held().empty());
}

}  // namespace
}  // namespace palpate::plan
