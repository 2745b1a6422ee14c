// Organs of one world that touch each other or themselves, pressed by probes.
#include <algorithm>
#include <catch2/catch.hpp>

#include "collision/contact_finder.h"
#include "deformation/organ_contacts.h"
#include "modules/core/error.h"
#include "modules/scene/probe_shape.h"
#include "tests/deformation/touching_organs.h"

namespace palpate::deformation {
namespace {

using testing::any_triangles_cross;
using testing::ball_at;
using testing::ball_organ;
using testing::kBallRadius;
using testing::kPeriod;

/// Organs in a world with plates, for their contacts.
ContactSet plate_on(const DeformationWorld& world, std::uint32_t organ, std::uint32_t probe,
                    const Vec3& at, int side) {
  ContactSet set;
  set.probe = probe;
  set.probe_pose.position = at;
  std::vector<bool> seen(world.model(organ).surface_node_count);
  const auto& triangles = world.model(organ).triangles;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t node = triangles[t][static_cast<std::size_t>(k)];
      if (seen[node]) continue;
      seen[node] = true;
      const Vec3& p = world.positions(organ)[node];
      Contact contact;
      contact.organ = organ;
      contact.triangle = t;
      contact.barycentric = Vec3::Unit(k);
      contact.gap = side * (at.z() - p.z());
      if (contact.gap > 4e-3) continue;
      contact.point_P = Vec3(p.x() - at.x(), p.y() - at.y(), 0);
      contact.normal_P = Vec3(0, 0, side);
      set.contacts.push_back(contact);
    }
  }
  return set;
}

void move_plate(DeformationWorld& world, std::uint32_t organ, std::uint32_t probe, const Vec3& at,
                int side) {
  ContactSet set = plate_on(world, organ, probe, at, side);
  std::sort(set.contacts.begin(), set.contacts.end(),
            [](const Contact& a, const Contact& b) { return a.triangle < b.triangle; });
  world.set_contacts(set);
  world.set_probe(probe, Pose{at, Quat::Identity()});
}

scene::Scene stacked_scene(double friction, bool self = false) {
  scene::Scene scene = testing::ball_scene(2);
  scene.organs.push_back(scene.organs[0]);
  scene.organs[0].name = "upper";
  scene.organs[1].name = "lower";
  for (auto& organ : scene.organs) organ.tissue.drag = 10;
  for (auto& probe : scene.probes) probe.friction = 0.5;
  scene.contacts = {true, self, friction};
  return scene;
}

DeformationWorld stacked_world(const scene::Scene& scene, int levels) {
  const double z = kBallRadius + OrganContacts::kRestGap / 2;
  return DeformationWorld(scene, {ball_at(Vec3(0, 0, z), levels), ball_at(Vec3(0, 0, -z), levels)});
}

TEST_CASE("world contacts: a held organ is felt as a probe of the same shape is") {
  // Oracle: the contacts of a mesh probe, found and solved by other code. 5 %: the organ keeps
  // kRestGap, 2 % of the 1 cm pressed, off, and force grows with the 3/2th power of that.
  scene::Scene scene = stacked_scene(0.1);
  for (auto& organ : scene.organs) organ.springs.inner_ratio = 10;
  scene.organs[1].fixed.push_back(scene::BoxRegion{Vec3(-1, -1, -0.095), Vec3(1, 1, 1)});
  scene.probes[1].friction = 0.1;
  const Vec3 above(0.013, 0.007, 0.0501), below(0, 0, -0.0501);
  DeformationWorld touching(scene, {ball_at(above, 3), ball_at(below, 3)});
  scene.contacts.organs = false;
  scene.organs.pop_back();
  DeformationWorld probed(scene, {ball_at(above, 3)});
  collision::ContactFinder finder({probed.model(0).triangles},
                                  {scene::form_of(scene.probes[0].shape), ball_at({0, 0, 0}, 3)});
  double force = 0, probe_force = 0;
  for (double time = 0; time < 2.25; time += kPeriod) {
    const Vec3 plate(0, 0, 0.1002 - 0.01 * std::min(time, 1.0));
    move_plate(touching, 0, 0, plate, 1);
    touching.advance(kPeriod);
    move_plate(probed, 0, 0, plate, 1);
    const Pose pose{below, Quat::Identity()};
    ContactSet contacts;
    finder.update_organ(0, probed.positions(0));
    finder.find(1, {pose, pose}, 2e-3, {1024, 0, 0}, contacts);
    probed.set_probe(1, pose);
    probed.set_contacts(contacts);
    probed.advance(kPeriod);
    if (time < 2) continue;
    force += touching.force(0).z();
    probe_force += probed.force(0).z();
  }
  INFO("forces " << force << " and " << probe_force << ", contacts "
                 << touching.read(0).organ_contacts);
  CHECK(touching.read(0).organ_contacts > 5);
  CHECK(touching.read(0).organ_contacts == touching.read(1).organ_contacts);
  CHECK(force == Approx(probe_force).epsilon(0.05));
}

TEST_CASE("world contacts: a minute of pushing and rubbing, and nothing has passed through") {
  // Oracle: brute force over all pairs of triangles, twice a second.
  auto world = stacked_world(stacked_scene(0.2, true), 2);
  bool crossed = false, cut = false;
  std::size_t touches = 0;
  int step = 0;
  for (double time = 0; time < 60; time += kPeriod, ++step) {
    const double press = 0.03 * std::min(time, 1.0) * (1 + 0.3 * std::sin(2 * time));
    const Vec3 rub = 0.03 * Vec3(std::sin(1.7 * time), 1 - std::cos(1.7 * time), 0);
    move_plate(world, 0, 0, Vec3(0, 0, 2 * kBallRadius - press) + rub, 1);
    move_plate(world, 1, 1, Vec3(0, 0, -2 * kBallRadius + press) - rub, -1);
    const AdvanceReport report = world.advance(kPeriod);
    cut |= report.organ_motion_cut;
    REQUIRE_FALSE(report.diverged);
    touches += world.read(0).organ_contacts;
    if (step % 125 != 0) continue;
    crossed |= any_triangles_cross(
        {{world.positions(0), &world.model(0)}, {world.positions(1), &world.model(1)}});
  }
  CHECK(touches > 10000);
  CHECK_FALSE(crossed);
  CHECK_FALSE(cut);
}

TEST_CASE("world contacts: a wide touch of fine meshes is held by every row it takes") {
  // Oracle: brute force over all pairs of triangles. More contacts than a message of collision
  // holds: there is no number past which some are left out, and neither sweeps nor motion are cut.
  auto world = stacked_world(stacked_scene(0.2, true), 4);
  std::size_t most = 0;
  bool cut = false, unsolved = false;
  for (double time = 0; time < 0.5; time += kPeriod) {
    const double press = 0.03 * std::min(time / 0.4, 1.0);
    move_plate(world, 0, 0, Vec3(0, 0, 2 * kBallRadius - press), 1);
    move_plate(world, 1, 1, Vec3(0, 0, -2 * kBallRadius + press), -1);
    const AdvanceReport report = world.advance(kPeriod);
    REQUIRE_FALSE(report.diverged);
    cut |= report.organ_motion_cut;
    unsolved |= report.organ_contacts_unsolved;
    most = std::max(most, world.read(0).organ_contacts);
  }
  CHECK(most > 1024);
  CHECK_FALSE(cut);
  CHECK_FALSE(unsolved);
  CHECK_FALSE(any_triangles_cross(
      {{world.positions(0), &world.model(0)}, {world.positions(1), &world.model(1)}}));
}

TEST_CASE("world contacts: the same inputs give the same bits") {
  // Oracle: a second run.
  std::vector<std::vector<Vec3>> ends;
  for (int run = 0; run < 2; ++run) {
    auto world = stacked_world(stacked_scene(0.2, true), 2);
    for (double time = 0; time < 0.5; time += kPeriod) {
      move_plate(world, 0, 0, Vec3(0, 0.1 * time, 2 * kBallRadius - 0.05 * time), 1);
      move_plate(world, 1, 1, Vec3(0, 0, -2 * kBallRadius), -1);
      world.advance(kPeriod);
    }
    const auto upper = world.positions(0);
    ends.emplace_back(upper.begin(), upper.end());
  }
  CHECK(ends[0] == ends[1]);
}

TEST_CASE("world contacts: a wall pushed onto the far wall touches it and does not pass through") {
  // Oracle: brute force over all pairs of triangles; without the switch it does pass. A finger
  // dents a ball whose walls neither contents nor springs inside hold apart.
  scene::Organ organ = ball_organ();
  organ.model = "mass_spring";
  organ.springs = {0.1, 0, 0};
  organ.tissue.drag = 10;
  organ.fixed.push_back(scene::BoxRegion{Vec3(-1, -1, -1), Vec3(1, 1, -0.02)});
  for (const bool self : {true, false}) {
    scene::Scene scene = testing::ball_scene(1, organ);
    scene.probes[0].shape = scene::SphereShape{0.015};
    scene.contacts.self = self;
    DeformationWorld world(scene, {geometry::make_ball(kBallRadius, 2)});
    collision::ContactFinder finder({world.model(0).triangles},
                                    {scene::form_of(scene.probes[0].shape)});
    bool crossed = false;
    std::size_t touches = 0;
    Pose last{Vec3(0, 0, 0.07), Quat::Identity()};
    int step = 0;
    for (double time = 0; time < 2.5 && !crossed; time += kPeriod, ++step) {
      const Pose pose{Vec3(0, 0, 0.07 - 0.11 * std::min(time / 2, 1.0)), Quat::Identity()};
      ContactSet contacts;
      finder.update_organ(0, world.positions(0));
      finder.find(0, {last, pose}, 2e-3, {1024, 0, 0}, contacts);
      last = pose;
      world.set_probe(0, pose);
      world.set_contacts(contacts);
      world.advance(kPeriod);
      touches = std::max(touches, world.read(0).organ_contacts);
      if (step % 10 != 0) continue;
      crossed |= any_triangles_cross({{world.positions(0), &world.model(0)}});
    }
    INFO("touches " << touches << ", crossed " << crossed);
    CHECK((touches > 0) == self);
    CHECK(crossed == !self);
  }
}

TEST_CASE("world contacts: organs that cross or touch at rest are refused by name") {
  // Oracle: the message.
  scene::Scene scene = stacked_scene(0);
  const auto said = [&](double distance) -> std::string {
    try {
      DeformationWorld world(scene, {ball_at(Vec3(0, 0, distance), 1), ball_at(Vec3::Zero(), 1)});
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  const std::string refused =
      "scene: key 'contacts.organs': organs 'upper' and 'lower' cross or touch at rest, where they "
      "must be "
      "1e-05 m apart at least";
  CHECK(said(0.08) == refused);
  CHECK(said(0.1) == refused);
  CHECK(said(0.11) == "");
}

TEST_CASE("world contacts: a world refuses models and integrators that do not take them") {
  // Oracle: the message. Automatic becomes symplectic Euler.
  scene::Scene scene = stacked_scene(0);
  const auto said = [&]() -> std::string {
    try {
      stacked_world(scene, 1);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  CHECK(said() == "");
  scene.organs[1].integrator = scene::Integrator::kBackwardEuler;
  CHECK_THAT(said(), Catch::Contains("'contacts.organs'") && Catch::Contains("backward_euler") &&
                         Catch::Contains("'lower'"));
  scene.organs[1].integrator = scene::Integrator::kAutomatic;
  scene.organs[1].model = "xpbd_springs";
  CHECK_THAT(said(), Catch::Contains("xpbd_springs") && Catch::Contains("'lower'"));
}

}  // namespace
}  // namespace palpate::deformation
