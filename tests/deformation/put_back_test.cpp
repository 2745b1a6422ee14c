// A guard puts an organ elsewhere while a probe stands in it.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "collision/contact_finder.h"
#include "deformation/world.h"
#include "modules/geometry/primitives.h"
#include "modules/geometry/winding_number.h"
#include "modules/scene/probe_shape.h"
#include "tests/deformation/organs.h"

namespace palpate::deformation {
namespace {

using testing::kBallRadius, testing::kPeriod;

constexpr double kTip = 4e-3, kDepth = 15e-3;  // [m]
constexpr double kPressed = 0.1;               // [s]

/// A ball, held from below, pressed by a tip; searched before every advance.
class Pressed {
 public:
  Pressed()
      : scene_(scene_of()),
        world_(scene_, {ball()}),
        finder_({ball().triangles}, {scene::form_of(scene_.probes[0].shape)}) {}

  AdvanceReport advance() {
    const double way = std::min(time_ / kPressed, 1.0);
    const Pose pose{Vec3(0, 0, kBallRadius + kTip - way * kDepth), Quat::Identity()};
    finder_.update_organ(0, world_.positions(0));
    finder_.find(0, {before_, pose}, 2e-3, {1024, 0, 0}, contacts_);
    inside_ = geometry::winding_number(pose.position, world_.positions(0),
                                       world_.model(0).triangles) > 0.5;
    before_ = pose;
    world_.set_probe(0, pose);
    world_.set_contacts(contacts_);
    time_ += kPeriod;
    return world_.advance(kPeriod);
  }
  /// What no solver survives.
  void fail() {
    ContactSet none;
    none.probe = 1;
    none.contacts.emplace_back().normal_P = Vec3::Constant(std::nan(""));
    none.contacts[0].barycentric = Vec3::UnitX();
    const auto& triangles = world_.model(0).triangles;
    while (world_.positions(0)[triangles[none.contacts[0].triangle][0]].z() <= 0) {
      ++none.contacts[0].triangle;
    }
    world_.set_probe(1, Pose{});
    world_.set_contacts(none);
  }
  void heal() {
    ContactSet none;
    none.probe = 1;
    world_.set_contacts(none);
  }
  double time() const { return time_; }
  double force() const { return world_.force(0).z(); }
  bool was_inside() const { return inside_; }
  double found_gap() const { return contacts_.deepest_gap(); }

 private:
  static geometry::TriangleSurface ball() { return geometry::make_ball(kBallRadius, 3); }
  static scene::Scene scene_of() {
    scene::Scene scene = testing::ball_scene(2);
    scene.organs[0].fixed = {scene::BoxRegion{Vec3(-1, -1, -1), Vec3(1, 1, 0)}};
    scene.organs[0].tissue.drag = 40;
    scene.probes[0].shape = scene::SphereShape{kTip};
    return scene;
  }

  scene::Scene scene_;
  DeformationWorld world_;
  collision::ContactFinder finder_;
  Pose before_{Vec3(0, 0, kBallRadius + kTip), Quat::Identity()};
  ContactSet contacts_;
  double time_ = 0;
  bool inside_ = false;
};

struct Run {
  int inside = 0, lost = 0;                 ///< searches; without a contact that pushes
  double greatest = 0, last = 0, back = 0;  ///< force [N]; after the put-back; when it is felt [s]
  bool to_rest = false;
};

/// So many failures one after the other from an instant on; an organ is put to rest by the fourth.
Run run(double failing_from, int failures) {
  Pressed pressed;
  Run run;
  while (pressed.time() < 5) {
    const bool fails = pressed.time() > failing_from && failures > 0;
    if (fails) pressed.fail();
    const AdvanceReport report = pressed.advance();
    if (fails && --failures == 0) pressed.heal();
    run.to_rest |= report.back_to_rest;
    run.inside += pressed.was_inside();
    run.lost += pressed.was_inside() && !(pressed.found_gap() < 0);
    if (pressed.time() < failing_from) continue;
    run.greatest = std::max(run.greatest, pressed.force());
    run.last = pressed.force();
    if (!(pressed.force() > 0)) run.back = pressed.time() - failing_from;
  }
  return run;
}

TEST_CASE("put back: around a probe contact is found at once, and tissue goes back to it gently") {
  // Oracle: winding number at each search; the force of the same press undisturbed, which comes
  // back and is not passed by more than a tenth. One failure while the tip goes in, so that it is
  // inside what is put back, and four while it rests: then contacts are suspended for kQuietTime.
  const Run undisturbed = run(0, 0), resting = run(2, 4);
  CHECK(undisturbed.inside == 0);
  int inside = 0;
  for (const double failing_from : {0.5, 0.6, 0.7, 0.8, 0.9, 1.0}) {
    const Run moving = run(failing_from * kPressed, 1);
    INFO("failing at " << failing_from << " of the way, " << moving.inside << " searches inside");
    CHECK(moving.lost == 0);
    CHECK_FALSE(moving.to_rest);
    CHECK(moving.back < 5 * kPeriod);
    CHECK(moving.last == Approx(undisturbed.last).epsilon(0.05));
    CHECK(moving.greatest < 1.1 * undisturbed.greatest);
    inside += moving.inside;
  }
  CHECK(inside > 0);
  CHECK(resting.inside * kPeriod > kQuietTime);
  CHECK(resting.lost == 0);
  CHECK(resting.to_rest);
  CHECK(resting.back < kQuietTime + 10 * kPeriod);
  CHECK(resting.last == Approx(undisturbed.last).epsilon(0.05));
  CHECK(resting.greatest < 1.1 * undisturbed.last);
}

}  // namespace
}  // namespace palpate::deformation
