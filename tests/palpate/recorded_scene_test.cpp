#include "palpate/recorded_scene.h"

#include <catch2/catch.hpp>

#include "modules/core/error.h"
#include "modules/scene/scene_reader.h"
#include "modules/scene/settings.h"
#include "tests/palpate/ball_scene.h"

using namespace palpate;
using namespace palpate::launcher;

namespace {

using Stages = std::set<std::string>;

}  // namespace

TEST_CASE("recorded scene: it may differ in what the stages read that are computed anew") {
  // Oracle: which stage reads which key, by hand; triangles that contacts name are of both.
  const palpate::testing::BallScene files("topic: {start_m: [0, 0, 0.09]}");
  const scene::Scene recorded = scene::load_scene(files.file());
  SceneDescription told;
  told.digest = scene::scene_digest(recorded);
  told.resolved_text = scene::resolved_text(recorded);
  const auto taken = [&](const std::string& setting, const Stages& stages, bool other_hand) {
    const scene::Scene scene = scene::load_scene_with(files.file(), {setting});
    try {
      check_scene_of_rerun("run.mcap", told, scene, stages, other_hand);
      return true;
    } catch (const InputError&) {
      return false;
    }
  };
  const Stages haptics{"haptics"}, collision{"collision"}, deformation{"deformation"};
  const Stages both{"collision", "deformation"}, all{"haptics", "collision", "deformation"};
  const std::vector<std::pair<std::string, std::vector<Stages>>> readers{
      {"haptics.max_force_n=1", {haptics}},
      {"rates.haptics_hz=500", {haptics}},
      {"probes[0].shape.sphere.radius_m=0.02", {collision, both}},
      {"rates.collision_hz=100", {collision, both}},
      {"organs[0].tissue.youngs_modulus_pa=8e3", {deformation, both}},
      {"gravity_m_per_s2=[0, 0, -1]", {deformation, both}},
      {"probes[0].friction=0.3", {deformation, both}},
      {"organs[0].mesh.nodes=200", {both}},
      {"organs[0].position_m=[0, 0, 0.01]", {both}},
      {"organs[0].model=penalty", {both}},
      {"duration_s=3", {haptics, collision, deformation, both}}};
  for (const auto& [setting, allowed] : readers) {
    for (const Stages& stages : {haptics, collision, deformation, both}) {
      INFO(setting << " " << *stages.begin() << stages.size());
      const bool is_allowed = std::ranges::find(allowed, stages) != allowed.end();
      CHECK(taken(setting, stages, false) == is_allowed);
      const bool of_the_hand = allowed.front() == haptics;
      CHECK(taken(setting, stages, true) == (is_allowed || of_the_hand));
    }
    CHECK(taken(setting, all, false));
  }
}
