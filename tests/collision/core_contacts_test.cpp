#include "collision/core_contacts.h"

#include <catch2/catch.hpp>

#include "tests/collision/step_scene.h"

namespace palpate::collision {
namespace {

const Core kSphere{0, Vec3::Zero(), Vec3::Zero(), 0.5};

std::vector<FoundContact> find(CoreContacts& cores, const StepScene& scene, const Core& core) {
  std::vector<FoundContact> found;
  cores.begin_step();
  cores.find(scene.step, core, scene.triangles(), found);
  return found;
}

}  // namespace

TEST_CASE("core contacts: in front of a wall, one contact per triangle within the margin") {
  // Oracle: analytic; the box's top is 0.55 below the sphere's centre.
  const StepScene scene(box_at({0.1, 0.2, -1.55}, {2, 2, 2}), Vec3::Zero());
  CoreContacts cores;
  const auto found = find(cores, scene, kSphere);
  REQUIRE_FALSE(found.empty());
  double gap = 1;
  for (const FoundContact& c : found) {
    gap = std::min(gap, c.gap);
    CHECK(c.normal_P[2] > 0);
    CHECK(c.time_of_impact == 1);
    CHECK((c.point_P - (-0.5 * c.normal_P)).norm() < 1e-12);
  }
  CHECK(gap == Approx(0.05).margin(1e-12));
}

TEST_CASE("core contacts: a core inside an organ that it was not seen entering touches nothing") {
  // Oracle: invariant.
  const StepScene scene(box_at({0, 0, 0}, {1, 1, 1}), Vec3::Zero());
  CoreContacts cores;
  CHECK(find(cores, scene, kSphere).empty());
}

TEST_CASE("core contacts: a wall crossed in the step pushes out the way the core came") {
  // Oracle: analytic; the top face ends 0.7 above the centre, the bottom face 0.3 below it.
  const StepScene scene(box_at({0, 0, 0.2}, {4, 4, 1}, 2), {0, 0, 3});
  CoreContacts cores;
  const auto found = find(cores, scene, kSphere);
  REQUIRE_FALSE(found.empty());
  double gap = 0;
  for (const FoundContact& c : found) {
    gap = std::min(gap, c.gap);
    CHECK((c.normal_P - Vec3::UnitZ()).norm() < 1e-12);
    CHECK(c.time_of_impact == Approx((3 - 0.7 - 0.5) / 3).margin(1e-6));
  }
  CHECK(gap == Approx(-1.2).margin(1e-12));
  // Remembered at rest, with the wall's depth limit.
  std::vector<std::uint32_t> remembered;
  double depth_limit = 0;
  const StepScene rest(box_at({0, 0, 0.2}, {4, 4, 1}, 2), Vec3::Zero(), 0.1, 0.01);
  CHECK(find(cores, rest, kSphere).size() == found.size());
  cores.begin_step();
  cores.append_remembered(0, remembered, depth_limit);
  CHECK_FALSE(remembered.empty());
  CHECK(depth_limit == 10);
}

TEST_CASE("core contacts: deeper than believed, a wall is given up") {
  // Oracle: analytic; 1.2 deep after a crossing believed to 1.3 or to 1.1, then at rest.
  for (const double limit : {1.3, 1.1}) {
    const auto box = box_at({0, 0, 0.2}, {4, 4, 1}, 2);
    CoreContacts cores;
    CHECK_FALSE(find(cores, StepScene(box, {0, 0, 3}, 0.1, limit), kSphere).empty());
    const auto found = find(cores, StepScene(box, Vec3::Zero(), 0.1, limit), kSphere);
    CHECK(found.empty() == (limit < 1.2));
  }
}

TEST_CASE("core contacts: out again, the wall is in front and nothing is remembered") {
  // Oracle: analytic.
  CoreContacts cores;
  find(cores, StepScene(box_at({0, 0, 0.2}, {4, 4, 1}, 2), {0, 0, 3}), kSphere);
  const auto found =
      find(cores, StepScene(box_at({0, 0, -1.05}, {4, 4, 1}, 2), {0, 0, -1.25}), kSphere);
  REQUIRE_FALSE(found.empty());
  for (const FoundContact& c : found) CHECK(c.gap > 0);
  std::vector<std::uint32_t> remembered;
  double depth_limit = 0;
  cores.begin_step();
  cores.append_remembered(0, remembered, depth_limit);
  CHECK(remembered.empty());
}

TEST_CASE(
    "core contacts: out through another side nothing is remembered, out of the far side all is") {
  // Oracle: definition. In through the top; then the box moves away sideways, or further up.
  // Before, a needle pulled out beside its hole went on pulling at the hole's wall.
  for (const bool sideways : {true, false}) {
    CoreContacts cores;
    find(cores, StepScene(box_at({0, 0, 0.2}, {4, 4, 1}, 2), {0, 0, 3}), kSphere);
    const Vec3 way = sideways ? Vec3(-4, 0, 0) : Vec3(0, 0, 1.5);
    const auto found =
        find(cores, StepScene(box_at(Vec3(0, 0, 0.2) + way, {4, 4, 1}, 2), way), kSphere);
    CHECK(found.empty() == sideways);
    std::vector<std::uint32_t> remembered;
    double depth_limit = 0;
    cores.begin_step();
    cores.append_remembered(0, remembered, depth_limit);
    CHECK(remembered.empty() == sideways);
  }
}

TEST_CASE("core contacts: each core remembers for itself, and for each organ") {
  // Oracle: invariant.
  const StepScene scene(box_at({0, 0, 0.2}, {4, 4, 1}, 2), {0, 0, 3});
  CoreContacts cores;
  find(cores, scene, kSphere);
  cores.begin_step();
  std::vector<std::uint32_t> own, of_other_core, of_other_organ;
  cores.append_remembered(0, 0, own);
  cores.append_remembered(0, 1, of_other_core);
  cores.append_remembered(1, 0, of_other_organ);
  CHECK_FALSE(own.empty());
  CHECK(of_other_core.empty());
  CHECK(of_other_organ.empty());
  find(cores, scene, kSphere);
  cores.reset();
  cores.begin_step();
  own.clear();
  cores.append_remembered(0, 0, own);
  CHECK(own.empty());
}

TEST_CASE("core contacts: the point of a sharp probe has no radius") {
  // Oracle: analytic.
  const Core corner{3, Vec3::Zero(), Vec3::Zero(), 0};
  CoreContacts cores;
  const auto above =
      find(cores, StepScene(box_at({0.1, 0.6, -1.05}, {2, 2, 2}), Vec3::Zero()), corner);
  REQUIRE(above.size() == 1);
  CHECK(above[0].gap == Approx(0.05).margin(1e-12));
  CHECK(above[0].point_P == Vec3::Zero());
  const auto pierced =
      find(cores, StepScene(box_at({0.1, 0.6, -0.9}, {2, 2, 2}), {0, 0, 0.15}), corner);
  REQUIRE(pierced.size() == 1);
  CHECK(pierced[0].gap == Approx(-0.1).margin(1e-12));
  CHECK((pierced[0].normal_P - Vec3::UnitZ()).norm() < 1e-12);
}

}  // namespace palpate::collision
