#include "studies/plan/probe_paths.h"

#include <catch2/catch.hpp>

#include "modules/geometry/primitives.h"

namespace palpate::plan {
namespace {

TEST_CASE("probe paths: the truth is asked where probes touch, come to from outside") {
  // Oracle: a ball of 50 mm and a tip of 10 mm that goes down onto it: it touches below 60 mm.
  scene::Scene scene;
  scene::ScriptedDevice down;
  down.start = Vec3(0, 0, 0.08);
  down.moves = {{Vec3(0, 0, 0.054), 1.0}, {std::nullopt, 1.0}};
  scene.probes.push_back({"tip", scene::SphereShape{0.01}, 0.0, down});
  scene::ScriptedDevice far;
  far.start = Vec3(1, 0, 0);
  scene.probes.push_back({"far", scene::SphereShape{0.01}, 0.0, far});
  const ProbePaths paths(scene, geometry::make_ball(0.05, 3), 2);
  const auto times = paths.touching(4);
  REQUIRE(times.size() == 4);
  for (const double time : times) {
    std::vector<std::uint32_t> probes;
    const auto question = paths.question_at(time, probes);
    CHECK(probes == std::vector<std::uint32_t>{0});
    CHECK(question.stations.at(0).at(0).a.z() < 0.06);
    CHECK(question.free.at(0).a.z() > 0.0595);
    CHECK(question.free.at(0).a.head<2>().norm() < 2e-3);
  }
  CHECK(times.back() > 1);
  CHECK(ProbePaths(scene, geometry::make_ball(0.05, 3), 0.2).touching(4).empty());

  scene.probes[1].shape = scene::BoxShape{};
  CHECK_THROWS_WITH(check_shapes(scene), Catch::Contains("key 'probes[1].shape'"));
}

}  // namespace
}  // namespace palpate::plan
