#include "deformation/pressed_copy.h"

#include <algorithm>
#include <catch2/catch.hpp>

#include "deformation/models.h"
#include "deformation/world.h"
#include "modules/scene/models.h"
#include "organs.h"

namespace palpate::deformation {
namespace {

/// A ball on its lower part, pressed by a plate.
struct PressedBall {
  DeformationWorld world;
  double height = testing::kBallRadius;

  explicit PressedBall(const char* model) : world(scene_of(model), {shape()}) {}
  static geometry::OrganShape shape() { return {geometry::make_ball(testing::kBallRadius, 2)}; }
  static scene::Scene scene_of(const char* model) {
    scene::Organ organ = testing::ball_organ();
    organ.model = model;
    organ.fixed.push_back(scene::BoxRegion{Vec3(-1, -1, -1), Vec3(1, 1, -0.03)});
    return testing::ball_scene(1, organ);
  }
  void press() {
    height -= 0.02 * testing::kPeriod;
    world.set_contacts(testing::plate_contacts(world, 0, height, 1, 2e-3));
    world.set_probe(0, Pose{Vec3(0, 0, height), Quat::Identity()});
    world.advance(testing::kPeriod);
  }
};

TEST_CASE("pressed copy: an organ whose law was asked for moves as one nobody asked") {
  // Oracle: a second world, bit by bit. Of every model whose law presses copies and takes a ball.
  for (const ModelRow& row : model_rows()) {
    if (row.press_every == 0 || scene::is_solid(row.word)) continue;
    INFO(row.word);
    PressedBall asked(row.word), left(row.word);
    for (int i = 0; i < 40; ++i) {
      asked.press();
      left.press();
      const LocalLaw law = asked.world.local_law(0);
      if (i == 39) {
        CHECK(law.touching());
        CHECK(law.compliance == asked.world.local_law(0).compliance);
      }
    }
    CHECK(std::ranges::equal(asked.world.positions(0), left.world.positions(0)));
    CHECK(asked.world.force(0) == left.world.force(0));
  }
}

}  // namespace
}  // namespace palpate::deformation
