#include <catch2/catch.hpp>

#include "modules/geometry/winding_number.h"
#include "tests/collision/finder_scene.h"

namespace palpate::collision {
namespace {

constexpr double kFastest = 0.5;  // [m/s]
constexpr int kKinds = 7;         // of shapes

scene::ProbeShape shape_of(int kind) {
  switch (kind) {
    case 0:
      return scene::SphereShape{0.004};
    case 1:
      return scene::CapsuleShape{0.003, 0.02};
    case 2:
      return scene::BoxShape{Vec3(0.01, 0.014, 0.006)};
    case 3:
      return scene::ConeShape{0.003, 0.02};
    case 4:
      return scene::GrasperShape{0.015, 0.005, 0.003, 0.4};
    case 5:
      return scene::CapsuleShape{0.0005, 0.05};
    default:
      return scene::MeshShape{};
  }
}

geometry::ProbeForm probe(int kind) {
  return scene::form_of(shape_of(kind), geometry::make_capsule(0.004, 0.01, 8));
}

/// Moves the probe along a line through the organ; did it ever touch, and did the first contacts
/// push it back?
void pass_through(FinderScene& scene, const Vec3& direction, const Vec3& aim, const Quat& rotation,
                  double rate, double phase, const Quat& turn = Quat::Identity()) {
  scene.finder.reset();
  const double step = kFastest / rate;
  Pose pose = at(aim - (0.12 + phase * step) * direction, rotation);
  bool touched = false;
  while ((pose.position - aim).dot(direction) < 0.12 && !touched) {
    Pose next = pose;
    next.position += step * direction;
    next.rotation = turn * next.rotation;
    const ContactSet found = scene.find({pose, next}, 0.0005);
    for (const Contact& c : found.contacts) {
      touched = touched || (c.gap < 0 && normal_W(found, c).dot(direction) < 0);
    }
    pose = next;
  }
  if (!touched) {
    FAIL_CHECK("passed along " << direction.transpose() << " through " << aim.transpose() << " at "
                               << rate << " Hz");
  }
}

/// Points of a probe that are inside an organ when it is: of the core of a round one, else corners.
std::vector<Vec3> points_of(int kind) {
  const geometry::ProbeForm form = probe(kind);
  if (const auto* round = std::get_if<geometry::RoundedSegment>(&form)) {
    std::vector<Vec3> points;
    for (int i = 0; i <= 40; ++i) points.push_back(round->a + i / 40.0 * (round->b - round->a));
    return points;
  }
  return geometry::surface_of(form, 1).nodes;
}

}  // namespace

TEST_CASE("tunnelling: no probe at 500 mm/s passes an organ without contact, at any rate") {
  // Oracle: analytic; the line passes through the organ's inside, so the probe must touch.
  auto tetrahedron = geometry::make_tetrahedron(0.06);
  const std::vector<geometry::TriangleSurface> organs{geometry::make_ball(0.03, 2), tetrahedron,
                                                      geometry::make_box({0.08, 0.08, 0.0005}, 1),
                                                      geometry::make_box({0.08, 0.08, 0.002}, 4)};
  RandomShapes random(21);
  for (int kind = 0; kind < kKinds; ++kind) {
    for (const auto& organ : organs) {
      FinderScene scene({organ}, {probe(kind)});
      for (const double rate : {10.0, 25.0, 60.0, 250.0}) {
        for (int trial = 0; trial < (rate > 100 ? 4 : 12); ++trial) {
          const Vec3 aim = 0.2 * random.number(-1, 1) * organ.nodes[trial % organ.nodes.size()];
          const Quat turn(Eigen::AngleAxisd(trial % 3 == 0 ? 0.2 : 0, random.direction()));
          pass_through(scene, random.direction(), aim, random.rotation(), rate, random.number(0, 1),
                       turn);
        }
      }
    }
  }
}

TEST_CASE("tunnelling: axis-aligned ways through nodes and edges are no exception") {
  // Oracle: analytic. The degenerate ways: straight through nodes, along edges.
  const auto ball = geometry::make_ball(0.03, 2);
  for (int kind = 0; kind < kKinds; ++kind) {
    FinderScene scene({ball}, {probe(kind)});
    for (int axis = 0; axis < 3; ++axis) {
      for (const double sign : {1.0, -1.0}) {
        for (const double rate : {10.0, 40.0}) {
          pass_through(scene, sign * Vec3::Unit(axis), Vec3::Zero(), Quat::Identity(), rate, 0.5);
        }
      }
    }
    for (std::size_t node = 0; node < ball.nodes.size(); node += 7) {
      pass_through(scene, -ball.nodes[node].normalized(), Vec3::Zero(), Quat::Identity(), 10, 0.3);
    }
  }
}

TEST_CASE("tunnelling: a plane that sweeps over a whole ball keeps hold of its near half") {
  // Oracle: brute force; the nodes that face the plane.
  const auto ball = geometry::make_ball(0.03, 2);
  FinderScene scene(ball, scene::PlaneShape{});
  const Quat down(Eigen::AngleAxisd(M_PI, Vec3::UnitX()));
  const ContactSet found = scene.find({at({0, 0, 0.05}, down), at({0, 0, -0.05}, down)}, 0.001);
  std::size_t facing = 0;
  for (const Vec3& x : ball.nodes) facing += x[2] > 1e-9;
  CHECK(found.contacts.size() == facing);
  for (const Contact& c : found.contacts) {
    CHECK(c.gap == Approx(-0.05 - scene.tissue_point(c)[2]).margin(1e-12));
  }
}

TEST_CASE("tunnelling: grazing in passing is found with the depth of the graze") {
  // Oracle: analytic; a sphere passes a slab's edge with 2 mm overlap within one step.
  FinderScene scene(geometry::make_box({0.1, 0.1, 0.01}, 4), scene::SphereShape{0.006});
  const Vec3 from(0.054, 0.003, 0.1), to(0.054, 0.003, -0.1);
  const ContactSet found = scene.find({at(from), at(to)}, 0.001);
  REQUIRE_FALSE(found.contacts.empty());
  CHECK(deepest_gap(found) == Approx(-0.002).margin(1e-6));
}

TEST_CASE("tunnelling: a wall once passed keeps its side until the probe is back out") {
  // Oracle: analytic; depth below a floor.
  FinderScene scene(geometry::make_box({0.1, 0.1, 0.1}, 8), scene::SphereShape{0.006});
  Pose pose = at({0.003, 0.001, 0.07});
  double inside = 0;
  for (const double z : {0.045, 0.043, 0.040, 0.043, 0.049, 0.0555, 0.0565}) {
    Pose next = pose;
    next.position[2] = z;
    const ContactSet found = scene.find({pose, next}, 0.002);
    REQUIRE_FALSE(found.contacts.empty());
    CHECK(deepest_gap(found) == Approx(z - 0.006 - 0.05).margin(1e-9));
    for (const Contact& c : found.contacts) CHECK(normal_W(found, c)[2] > 0);
    inside += z < 0.05;
    pose = next;
  }
  CHECK(inside == 5);
}

TEST_CASE("tunnelling: below the skin, a sliding probe keeps pushing out through the near wall") {
  // Oracle: analytic; depth below a floor while sliding over many triangles.
  FinderScene scene(geometry::make_box({0.1, 0.1, 0.02}, 16), scene::SphereShape{0.004});
  Pose pose = at({-0.03, 0.001, 0.03});
  for (int step = 0; step < 30; ++step) {
    const Pose next = at({-0.03 + 0.002 * step, 0.001, 0.008});
    const ContactSet found = scene.find({pose, next}, 0.001);
    REQUIRE_FALSE(found.contacts.empty());
    CHECK(deepest_gap(found) == Approx(-0.006).margin(1e-3));
    for (const Contact& c : found.contacts) CHECK(normal_W(found, c)[2] > 0.5);
    pose = next;
  }
}

TEST_CASE("tunnelling: an organ that springs over a resting probe has not swallowed it") {
  // Oracle: analytic; only the relative motion counts.
  FinderScene scene(geometry::make_box({0.1, 0.1, 0.02}, 8), scene::SphereShape{0.004});
  const ProbeMotion motion = resting({0.001, 0.002, 0.02});
  CHECK(scene.find(motion, 0.001).contacts.empty());
  for (Vec3& x : scene.organs[0].nodes) x[2] += 0.02;  // its top from 0.01 to 0.03
  scene.update();
  const ContactSet found = scene.find(motion, 0.001);
  REQUIRE_FALSE(found.contacts.empty());
  CHECK(deepest_gap(found) == Approx(0.02 - 0.004 - 0.03).margin(1e-9));
}

TEST_CASE("tunnelling: reset forgets the side: the nearest wall pushes out, and it is said") {
  // Oracle: analytic; in through the top, the box's side at x = 0.05 is nearer.
  FinderScene scene(geometry::make_box({0.1, 0.1, 0.1}, 8), scene::SphereShape{0.006});
  const Pose inside = at({0.045, 0, 0.03});
  const auto nearest = [&](const ContactSet& found) {
    REQUIRE_FALSE(found.contacts.empty());
    const auto deepest =
        std::min_element(found.contacts.begin(), found.contacts.end(),
                         [](const Contact& a, const Contact& b) { return a.gap < b.gap; });
    return normal_W(found, *deepest);
  };
  CHECK(nearest(scene.find({at({0.045, 0, 0.06}), inside}, 0.002))[2] == Approx(1));
  CHECK(nearest(scene.find({inside, inside}, 0.002))[2] == Approx(1));
  CHECK_FALSE(scene.report.begun_inside);
  scene.finder.forget(0);
  const ContactSet found = scene.find({inside, inside}, 0.002);
  CHECK(scene.report.begun_inside);
  CHECK(nearest(found)[0] == Approx(1));
  CHECK(deepest_gap(found) == Approx(-0.011).margin(1e-12));
  scene.find({inside, inside}, 0.002);
  CHECK_FALSE(scene.report.begun_inside);
}

TEST_CASE("tunnelling: inside without contact is noticed and healed in the same search") {
  // Oracle: by construction; an organ that vanished for a search comes back around the probe.
  for (const auto& shape :
       {scene::ProbeShape(scene::SphereShape{0.006}), scene::ProbeShape(scene::BoxShape{})}) {
    FinderScene scene(geometry::make_box({0.1, 0.1, 0.1}, 8), shape);
    const Pose above = at({0.003, 0.001, 0.07}), inside = at({0.003, 0.001, 0.03});
    CHECK(scene.find({above, above}, 0.002).contacts.empty());
    auto gone = scene.organs[0].nodes;
    gone[0][0] = std::numeric_limits<double>::quiet_NaN();
    scene.finder.update_organ(0, gone);
    CHECK(scene.find({above, inside}, 0.002).contacts.empty());
    scene.update();
    const ContactSet found = scene.find({inside, inside}, 0.002);
    CHECK(scene.report.was_lost);
    CHECK(deepest_gap(found) < -0.01);
    scene.find({inside, inside}, 0.002);
    CHECK_FALSE(scene.report.was_lost);
  }
}

TEST_CASE("tunnelling: a tool that begins inside with nothing but its middle is pushed out") {
  // Oracle: by construction; no corner of the tool is in the organ, and none of the organ's in it.
  const Vec3 rod(0.3, 0.01, 0.012);
  for (const bool is_mesh : {false, true}) {
    geometry::ProbeForm form = geometry::Box{rod};
    if (is_mesh) form = geometry::make_box(rod, 6);
    FinderScene scene({geometry::make_box({0.1, 0.1, 0.1})}, {form});
    const ContactSet found = scene.find(resting({0.004, 0.003, 0.02}), 0.002);
    CHECK(scene.report.begun_inside);
    CHECK(deepest_gap(found) < -0.02);  // the top is 30 mm above its middle
    CHECK_FALSE(scene.report.was_lost);
    scene.find(resting({0.004, 0.003, 0.02}), 0.002);
    CHECK_FALSE(scene.report.begun_inside);
    scene.find({at({0.004, 0.003, 0.02}), at({0.004, 0.003, 0.07})}, 0.002);
    CHECK(scene.find(resting({0.004, 0.003, 0.07}), 0.002).contacts.empty());  // out, and let go
  }
}

TEST_CASE("tunnelling: no part of a probe in a hurry is inside without a contact that pushes") {
  // Oracle: winding number of points all over the probe, on the surface of each search. The organ
  // is told of now and then, the probe goes in and out by up to its size between two searches.
  // Before, a rod between whose ends it was inside had none.
  RandomShapes random(11);
  for (int kind = 0; kind < kKinds; ++kind) {
    const std::vector<Vec3> points = points_of(kind);
    FinderScene scene({random.deformed_ball(0.03, 2)}, {probe(kind)});
    const auto rest = scene.organs[0].nodes;
    const Quat lying(Eigen::AngleAxisd(M_PI / 2, Vec3::UnitY()));  // what is long lies on the organ
    Pose pose = at({0, 0, 0.06}, lying);
    int inside = 0;
    for (int search = 0; search < 400; ++search) {
      if (random.number(0, 1) < 0.3) {
        const Vec3 wave = 100 * random.direction(),
                   way = random.number(0, 0.01) * random.direction();
        for (std::size_t i = 0; i < rest.size(); ++i) {
          scene.organs[0].nodes[i] = rest[i] + std::sin(wave.dot(rest[i])) * way;
        }
        scene.update();
      }
      const Vec3 to = random.point(0.01) + random.number(0.02, 0.045) * Vec3::UnitZ();
      const Vec3 way = to - pose.position;
      const Pose next = at(pose.position + std::min(1.0, 0.01 / way.norm()) * way, lying);
      const ContactSet found = scene.find({pose, next}, 0.005);
      const bool is_inside = std::ranges::any_of(points, [&](const Vec3& p) {
        return geometry::winding_number(next.to_world(p), scene.organs[0].nodes,
                                        scene.organs[0].triangles) > 0.5;
      });
      inside += is_inside;
      if (is_inside && !(deepest_gap(found) < 0)) {
        FAIL_CHECK("shape " << kind << ", search " << search << ": " << found.contacts.size()
                            << " contacts, gap " << deepest_gap(found));
      }
      pose = next;
    }
    CHECK(inside > 50);  // else nothing was tried
  }
}

TEST_CASE("tunnelling: going round a sharp corner is not going through it") {
  // Oracle: analytic; from beside a box to above it, the side wall stays free.
  FinderScene scene(geometry::make_box({0.04, 0.04, 0.04}, 2), scene::SphereShape{0.006});
  Pose pose = at({0.0261, 0, 0.01});
  for (int step = 1; step <= 60; ++step) {
    const double angle = 0.5 * M_PI * std::clamp((step - 20) / 20.0, 0.0, 1.0);
    const double up = std::min(step, 20) * 0.0005, left = std::max(0, step - 40) * 0.0005;
    const Pose next =
        at({0.02 + 0.0061 * std::cos(angle) - left, 0, 0.01 + up + 0.0061 * std::sin(angle)});
    for (const Contact& c : scene.find({pose, next}, 0.001).contacts) CHECK(c.gap > 0);
    pose = next;
  }
}

}  // namespace palpate::collision
