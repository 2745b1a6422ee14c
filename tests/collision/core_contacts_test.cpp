#include "collision/core_contacts.h"

#include <algorithm>
#include <catch2/catch.hpp>

#include "collision/core_wall.h"
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

/// Of the last step.
bool is_behind(CoreContacts& cores, std::uint32_t organ = 0, std::uint32_t core = 0) {
  std::vector<std::uint32_t> held;
  cores.begin_step();
  cores.append_held(organ, held);
  return std::find(held.begin(), held.end(), core) != held.end();
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
    CHECK((c.point_P - (-0.5 * c.normal_P)).norm() < 1e-12);
  }
  CHECK(gap == Approx(0.05).margin(1e-12));
}

TEST_CASE(
    "core contacts: a core inside an organ that it was not seen entering is held when asked") {
  // Oracle: analytic; the nearest side of the box is 0.5 - 0.3 away, along x.
  const StepScene scene(box_at({-0.3, 0.05, 0.1}, {1, 1, 1}), Vec3::Zero());
  CoreContacts cores;
  CHECK(find(cores, scene, kSphere).empty());
  cores.begin_step();
  CHECK(cores.hold_if_inside(scene.step, kSphere));
  CHECK_FALSE(cores.hold_if_inside(scene.step, kSphere));  // it is held already
  std::vector<std::uint32_t> wall;
  cores.append_near_wall(scene.step, kSphere, 8192, wall);
  CHECK_FALSE(wall.empty());
  std::vector<FoundContact> found;
  cores.find(scene.step, kSphere, scene.triangles(), found);
  REQUIRE_FALSE(found.empty());
  double gap = 0;
  for (const FoundContact& c : found) gap = std::min(gap, c.gap);
  CHECK(gap == Approx(-0.7).margin(1e-12));
  CHECK(found.front().normal_P[0] == Approx(1).margin(1e-12));
  CHECK(is_behind(cores));
  const StepScene away(box_at({-1.3, 0, 0}, {1, 1, 1}), Vec3::Zero());
  CoreContacts others;
  others.begin_step();
  CHECK_FALSE(others.hold_if_inside(away.step, kSphere));
}

TEST_CASE("core contacts: of a wall the nearest triangles are taken where few are asked for") {
  // Oracle: brute force over the whole wall.
  const StepScene scene(box_at({0.02, 0.03, 0.6}, {1, 1, 2}, 16), Vec3::Zero());
  const Core corner{0, Vec3::Zero(), Vec3::Zero(), 0};
  CoreContacts cores;
  cores.begin_step();
  REQUIRE(cores.hold_if_inside(scene.step, corner));
  std::vector<std::uint32_t> wall;
  cores.append_near_wall(scene.step, corner, 12, wall);
  CHECK(cores.wall_was_cut());
  REQUIRE(wall.size() == 12);
  std::vector<double> taken, all;
  for (const SweptTriangle& t : scene.triangles()) {
    const double distance = closest(corner, t.end).distance;
    all.push_back(distance);
    if (std::ranges::find(wall, t.index) != wall.end()) taken.push_back(distance);
  }
  std::ranges::sort(all);
  std::ranges::sort(taken);
  all.resize(taken.size());
  CHECK(taken == all);
}

TEST_CASE("core contacts: a segment is behind a wall between its ends as well") {
  // Oracle: analytic; a rod along x whose middle is 0.3 below a bar's top. Pressed in all along,
  // then it juts out of the bar at both ends; or found so. Before, it was taken to have come out.
  const Core rod{0, {-2, 0, 0}, {2, 0, 0}, 0.1};
  const StepScene wide(box_at({0, 0, -0.2}, {6, 4, 1}, 2), {0, 0, 1}),
      bar(box_at({0, 0, -0.2}, {1, 4, 1}, 2), Vec3::Zero());
  for (const bool pressed_in : {true, false}) {
    CoreContacts cores;
    if (pressed_in) find(cores, wide, rod);
    cores.begin_step();
    CHECK(cores.hold_if_inside(bar.step, rod) == !pressed_in);
    std::vector<FoundContact> found;
    cores.find(bar.step, rod, bar.triangles(), found);
    REQUIRE_FALSE(found.empty());
    double gap = 0;
    for (const FoundContact& c : found) gap = std::min(gap, c.gap);
    CHECK(gap == Approx(-0.4).margin(1e-12));
    CHECK(is_behind(cores));
  }
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
  }
  CHECK(gap == Approx(-1.2).margin(1e-12));
  // Remembered at rest.
  const StepScene rest(box_at({0, 0, 0.2}, {4, 4, 1}, 2), Vec3::Zero(), 0.1, 0.01);
  CHECK(find(cores, rest, kSphere).size() == found.size());
  CHECK(is_behind(cores));
}

TEST_CASE("core contacts: inside, a wall is never given up, beyond the far side it is") {
  // Oracle: the definition. Through the top of a box of height 1, deeper and deeper: 0.1 deep in
  // each step's belief, 0.9 deep inside; then, believed to 2, out below: 1.8 deep and 3.5.
  const auto box = [](double depth) { return box_at({0, 0, depth - 0.5}, {4, 4, 1}, 2); };
  CoreContacts cores;
  CHECK_FALSE(find(cores, StepScene(box(0.1), {0, 0, 0.2}, 0.1, 0.1), kSphere).empty());
  for (const double depth : {0.3, 0.5, 0.7, 0.9}) {
    const auto found = find(cores, StepScene(box(depth), {0, 0, 0.2}, 0.1, 0.1), kSphere);
    REQUIRE_FALSE(found.empty());
    double gap = 0;
    for (const FoundContact& c : found) gap = std::min(gap, c.gap);
    CHECK(gap == Approx(-depth - 0.5).margin(1e-12));
  }
  CHECK_FALSE(find(cores, StepScene(box(0.95), {0, 0, 0.05}, 0.1, 2.0), kSphere).empty());
  CHECK_FALSE(find(cores, StepScene(box(1.3), {0, 0, 0.35}, 0.1, 1.0), kSphere).empty());
  CHECK(find(cores, StepScene(box(3), {0, 0, 1.7}, 0.1, 1.0), kSphere).empty());
}

TEST_CASE("core contacts: out again, the wall is in front and nothing is remembered") {
  // Oracle: analytic.
  CoreContacts cores;
  find(cores, StepScene(box_at({0, 0, 0.2}, {4, 4, 1}, 2), {0, 0, 3}), kSphere);
  const auto found =
      find(cores, StepScene(box_at({0, 0, -1.05}, {4, 4, 1}, 2), {0, 0, -1.25}), kSphere);
  REQUIRE_FALSE(found.empty());
  for (const FoundContact& c : found) CHECK(c.gap > 0);
  CHECK_FALSE(is_behind(cores));
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
    CHECK(is_behind(cores) == !sideways);
  }
}

TEST_CASE("core contacts: each core remembers for itself, and for each organ") {
  // Oracle: invariant.
  const StepScene scene(box_at({0, 0, 0.2}, {4, 4, 1}, 2), {0, 0, 3});
  CoreContacts cores;
  for (const auto& [organ, core] : {std::pair(0u, 0u), std::pair(0u, 1u), std::pair(1u, 0u)}) {
    find(cores, scene, kSphere);
    CHECK(is_behind(cores, organ, core) == (organ == 0 && core == 0));
  }
  find(cores, scene, kSphere);
  cores.reset();
  CHECK_FALSE(is_behind(cores));
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

/// A block with a step in its top: a steep wall from (0, 4) to (0.1, 2.1) in x and z, then a floor.
/// At the ends, y = ±2, the wall stands back by 1: it is folded. `at` comes to the origin.
geometry::TriangleSurface stepped(const Vec3& at) {
  auto block = geometry::make_box({4, 4, 8}, 4);
  for (Vec3& x : block.nodes) {
    const bool on_wall = x.z() == 4 && (x.x() == 0 || x.x() == 1);
    const bool on_floor = x.z() == 4 && x.x() >= 1;
    if (on_floor) x = {x.x() == 1 ? 0.1 : x.x(), x.y(), 2.1};
    if (on_wall && std::abs(x.y()) == 2) x.x() -= 1;
    x -= at;
  }
  return block;
}

TEST_CASE("core contacts: in the corner of a dent, out of one side is behind the other") {
  // Oracle: analytic. Through the wall, down, and out of it below the floor by 1 mm: behind the
  // plane of the wall's far part, too.
  const Core corner{0, Vec3::Zero(), Vec3::Zero(), 0};
  CoreContacts cores;
  Vec3 last(0.3, 0.3, 3.05);
  std::vector<FoundContact> found;
  for (const Vec3& at : {Vec3(0, 0.3, 3.05), Vec3(0.05, 0.3, 2.05), Vec3(0.1002, 0.3, 2.099)}) {
    found = find(cores, StepScene(stepped(at), last - at), corner);
    last = at;
  }
  REQUIRE_FALSE(found.empty());
  for (const FoundContact& c : found) {
    CHECK((c.normal_P - Vec3::UnitZ()).norm() < 1e-9);
    CHECK(c.gap == Approx(-1e-3).margin(1e-9));
  }
  CHECK(is_behind(cores));
}

TEST_CASE("core contacts: the nearest wall pushes straight out") {
  // Oracle: analytic; 0.2 below the middle of the box's top.
  const StepScene scene(box_at({0.1, 0.2, -0.3}, {1, 1, 1}), Vec3::Zero());
  std::vector<FoundContact> found;
  for (const SweptTriangle& t : scene.triangles()) {
    const CoreCandidate candidate(kSphere, t);
    if (candidate.side < 0 && std::abs(candidate.pair.distance - 0.2) < 1e-12) {
      append_nearest(scene.step, kSphere, candidate, found);
    }
  }
  REQUIRE_FALSE(found.empty());
  CHECK(found[0].gap == Approx(-0.7).margin(1e-12));
  CHECK((found[0].normal_P - Vec3::UnitZ()).norm() < 1e-12);
  CHECK((found[0].point_P - Vec3(0, 0, -0.5)).norm() < 1e-12);
}

}  // namespace palpate::collision
