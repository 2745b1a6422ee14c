#include "collision/contact_finder.h"

#include <catch2/catch.hpp>
#include <map>
#include <set>

#include "collision/contact_reduction.h"
#include "tests/collision/finder_scene.h"

namespace palpate::collision {
namespace {

/// A slab whose top is z = 0, wide enough to be a floor.
geometry::TriangleSurface slab(double thickness = 0.02, int divisions = 10) {
  geometry::TriangleSurface box = geometry::make_box({0.2, 0.2, thickness}, divisions);
  for (Vec3& x : box.nodes) x[2] -= 0.5 * thickness;
  return box;
}

/// Every place on the front of a triangle within the margin, over all triangles.
std::map<std::array<double, 3>, double> brute_force(const geometry::TriangleSurface& organ,
                                                    const Vec3& center, double radius,
                                                    double margin) {
  std::map<std::array<double, 3>, double> gaps;
  for (const auto& t : organ.triangles) {
    const geometry::TriangleCorners corners{organ.nodes[t[0]], organ.nodes[t[1]],
                                            organ.nodes[t[2]]};
    const geometry::PointOnTriangle closest = geometry::closest_on_triangle(center, corners);
    const double gap = (center - closest.point).norm() - radius;
    if (gap > margin || geometry::unit_normal(corners).dot(center - corners[0]) <= 0) continue;
    // Rounded, so that a place found over two triangles is one.
    std::array<double, 3> place;
    for (int k = 0; k < 3; ++k) place[k] = std::round(closest.point[k] * 1e9);
    gaps[place] = gap;
  }
  return gaps;
}

}  // namespace

TEST_CASE("contact finder: a sphere on deformed balls finds what all triangles would") {
  // Oracle: brute force over all triangles.
  RandomShapes random(11);
  std::size_t contacts = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const auto ball = random.deformed_ball(0.05, 3);
    const Vec3 out = random.direction();
    const double radius = random.number(0.002, 0.012), margin = random.number(0.001, 0.004);
    FinderScene scene(ball, scene::SphereShape{radius});
    const Vec3 center = out * (0.055 + random.number(0.0, radius));
    const auto wanted = brute_force(ball, center, radius, margin);
    const ContactSet found = scene.find(resting(center), margin);
    CHECK(found.contacts.size() == wanted.size());
    contacts += found.contacts.size();
    for (const Contact& c : found.contacts) {
      const Vec3 tissue = scene.tissue_point(c);
      std::array<double, 3> place;
      for (int k = 0; k < 3; ++k) place[k] = std::round(tissue[k] * 1e9);
      const auto at = wanted.find(place);
      // A point at the edge of the rounding cell may fall into its neighbour: then by size above.
      if (at != wanted.end()) CHECK(c.gap == Approx(at->second).margin(1e-12));
    }
  }
  CHECK(contacts > 200);
}

TEST_CASE("contact finder: the gap of a sphere over a floor") {
  // Oracle: analytic.
  for (const double height : {0.0001, 0.001, 0.0019, -0.001, -0.004}) {
    FinderScene scene(slab(), scene::SphereShape{0.006});
    const ContactSet found = scene.find(resting({0.0013, 0.0021, 0.006 + height}), 0.002);
    CHECK(deepest_gap(found) == Approx(height).margin(1e-14));
    for (const Contact& c : found.contacts) CHECK(normal_W(found, c)[2] > 0);
  }
  FinderScene scene(slab(), scene::SphereShape{0.006});
  CHECK(scene.find(resting({0, 0, 0.0081}), 0.002).contacts.empty());
}

TEST_CASE("contact finder: the gap of a tilted capsule over a floor is that of its lower end") {
  // Oracle: analytic.
  FinderScene scene(slab(), scene::CapsuleShape{0.005, 0.04});
  for (const double angle : {0.0, 0.3, 1.0, 1.4, 1.5707}) {
    const Quat tilt(Eigen::AngleAxisd(angle, Vec3(1, 2, 0).normalized()));
    const double lower_end = 0.02 * std::cos(angle);
    scene.finder.reset();
    const ContactSet found =
        scene.find(resting({0.003, 0.001, lower_end + 0.005 + 0.0007}, tilt), 0.002);
    CHECK(deepest_gap(found) == Approx(0.0007).margin(1e-12));
  }
}

TEST_CASE("contact finder: a lying capsule touches along its length") {
  // Oracle: analytic; the segment is parallel to the floor.
  FinderScene scene(slab(), scene::CapsuleShape{0.005, 0.04});
  const Quat lying(Eigen::AngleAxisd(0.5 * M_PI, Vec3::UnitX()));
  const ContactSet found = scene.find(resting({0.001, 0.002, 0.0055}, lying), 0.001);
  double lowest = 1, highest = -1;
  for (const Contact& c : found.contacts) {
    if (c.gap > 0.0005 + 1e-12) continue;
    lowest = std::min(lowest, point_W(found, c)[1]);
    highest = std::max(highest, point_W(found, c)[1]);
  }
  CHECK(deepest_gap(found) == Approx(0.0005).margin(1e-12));
  CHECK(highest - lowest > 0.03);
}

TEST_CASE("contact finder: the gap of a box standing on a face, an edge and a corner") {
  // Oracle: analytic; the lowest corner's height over the floor.
  const Vec3 size(0.02, 0.03, 0.01);
  for (const auto& axis_angle : {std::pair(Vec3(1, 0, 0), 0.0), std::pair(Vec3(1, 0, 0), 0.6),
                                 std::pair(Vec3(1, 0.4, 0), 0.8), std::pair(Vec3(0, 0, 1), 0.3)}) {
    const Quat rotation(Eigen::AngleAxisd(axis_angle.second, axis_angle.first.normalized()));
    const double reach = (rotation.toRotationMatrix().row(2).cwiseAbs() * 0.5 * size)(0);
    FinderScene scene(slab(), scene::BoxShape{size});
    const ContactSet found = scene.find(resting({0.0007, 0.0003, reach + 0.0004}, rotation), 0.002);
    CHECK(deepest_gap(found) == Approx(0.0004).margin(1e-12));
    for (const Contact& c : found.contacts) CHECK(normal_W(found, c)[2] > 0.5);
  }
}

TEST_CASE("contact finder: a plane on a ball holds each near node once, with its height") {
  // Oracle: brute force; a node's height over the plane.
  const auto ball = geometry::make_ball(0.05, 3);
  FinderScene scene(ball, scene::PlaneShape{});
  const Quat down(Eigen::AngleAxisd(M_PI, Vec3::UnitX()));  // solid above, facing down
  const ContactSet found = scene.find(resting({0, 0, 0.045}, down), 0.002);
  std::size_t near = 0;
  for (const Vec3& x : ball.nodes) near += 0.045 - x[2] <= 0.002;
  CHECK(near > 20);
  CHECK(found.contacts.size() == near);
  for (const Contact& c : found.contacts) {
    CHECK(c.barycentric.maxCoeff() == 1);
    CHECK(c.gap == Approx(0.045 - scene.tissue_point(c)[2]).margin(1e-14));
    CHECK((normal_W(found, c) - Vec3::UnitZ()).norm() < 1e-12);
  }
}

TEST_CASE("contact finder: a far wall seen from inside is not in contact") {
  // Oracle: invariant; all contacts lie on the near wall. The organ is thinner than the probe.
  for (const scene::ProbeShape& shape :
       {scene::ProbeShape(scene::SphereShape{0.006}), scene::ProbeShape(scene::CapsuleShape{}),
        scene::ProbeShape(scene::BoxShape{}), scene::ProbeShape(scene::PlaneShape{})}) {
    FinderScene scene(slab(0.003), shape);
    const bool is_plane = std::holds_alternative<scene::PlaneShape>(shape);
    const Quat down(Eigen::AngleAxisd(is_plane ? M_PI : 0, Vec3::UnitX()));
    const double reach = std::visit(
        [](const auto& s) -> double {
          using Shape = std::decay_t<decltype(s)>;
          if constexpr (std::is_same_v<Shape, scene::SphereShape>) return s.radius;
          if constexpr (std::is_same_v<Shape, scene::CapsuleShape>)
            return s.radius + 0.5 * s.length;
          if constexpr (std::is_same_v<Shape, scene::BoxShape>) return 0.5 * s.size[2];
          return 0;
        },
        shape);
    Pose pose = at({0.001, 0.002, reach + 0.001}, down);
    for (int step = 0; step < 20; ++step) {
      Pose next = pose;
      next.position[2] -= 0.0001;
      const ContactSet found = scene.find({pose, next}, 0.005);
      for (const Contact& c : found.contacts) {
        CHECK(scene.tissue_point(c)[2] == Approx(0).margin(1e-12));
        CHECK(normal_W(found, c)[2] > 0);
      }
      pose = next;
    }
  }
}

TEST_CASE("contact finder: a deep dent gives its whole wall, not the wall behind it") {
  // Oracle: invariant; normals point from the tissue to the probe, on its own side.
  auto ball = geometry::make_ball(0.05, 4);
  const Vec3 center(0, 0, 0.02);
  // Dent the ball by a sphere that reaches nearly to its far side.
  for (Vec3& x : ball.nodes) {
    const double sideways = x.head<2>().norm();
    if (x[2] > 0 && sideways < 0.011) {
      x[2] = std::min(x[2], -0.045 + 0.012 - std::sqrt(0.012 * 0.012 - sideways * sideways));
    }
  }
  FinderScene scene(ball, scene::SphereShape{0.0118});
  const ContactSet found = scene.find(resting({0, 0, -0.033}), 0.004);
  REQUIRE(found.contacts.size() > 5);
  for (const Contact& c : found.contacts) {
    const auto& t = ball.triangles[c.triangle];
    const Vec3 outward = geometry::area_vector(ball.nodes, t);
    CHECK(outward[2] > -1e-3 * outward.norm());
    CHECK(normal_W(found, c).dot(outward) > 0);
  }
}

TEST_CASE("contact finder: a box edge between the nodes of a ridge is found") {
  // Oracle: analytic; two perpendicular edges at a known distance, no node or corner near.
  geometry::TriangleSurface ridge;  // a roof with its ridge along x at z = 0
  ridge.nodes = {{-0.1, 0, 0},     {0.1, 0, 0},        {-0.1, 0.1, -0.1},
                 {0.1, 0.1, -0.1}, {-0.1, -0.1, -0.1}, {0.1, -0.1, -0.1}};
  ridge.triangles = {{0, 1, 3}, {0, 3, 2}, {1, 0, 4}, {1, 4, 5}};
  for (auto& t : ridge.triangles) {
    if (geometry::area_vector(ridge.nodes, t)[2] < 0) std::swap(t[1], t[2]);
  }
  FinderScene scene(ridge, scene::BoxShape{{0.02, 0.08, 0.02}});
  const Quat on_edge(Eigen::AngleAxisd(M_PI / 4, Vec3::UnitY()));
  const double reach = 0.01 * std::sqrt(2.0);
  const ContactSet above = scene.find(resting({0.013, 0, reach + 0.001}, on_edge), 0.002);
  REQUIRE(above.contacts.size() == 1);
  CHECK(above.contacts[0].gap == Approx(0.001).margin(1e-12));
  CHECK((normal_W(above, above.contacts[0]) - Vec3::UnitZ()).norm() < 1e-9);
  // Pressed in by 2 mm within one step, and again at rest: it keeps its side.
  const Pose pressed = at({0.013, 0, reach - 0.002}, on_edge);
  const ContactSet below = scene.find({at({0.013, 0, reach + 0.001}, on_edge), pressed}, 0.002);
  CHECK(deepest_gap(below) == Approx(-0.002).margin(1e-9));
  CHECK(deepest_gap(scene.find({pressed, pressed}, 0.002)) == Approx(-0.002).margin(1e-9));
}

TEST_CASE("contact finder: two finders give the same bits, whatever else they were asked") {
  // Oracle: invariant, bit for bit.
  RandomShapes random(13);
  const auto ball = random.deformed_ball(0.05, 3);
  const auto run = [&](int extra) {
    FinderScene scene({ball, ball}, {probe_of(scene::SphereShape{}), probe_of(scene::BoxShape{})});
    std::vector<ContactSet> all;
    Pose pose = at({0, 0.001, 0.07});
    for (int step = 0; step < 20; ++step) {
      for (auto& organ : scene.organs) {
        for (Vec3& x : organ.nodes) x *= 0.999;
      }
      scene.update();
      Pose next = pose;
      next.position[2] -= 0.001;
      all.push_back(scene.find({pose, next}, 0.002, 0));
      for (int k = 0; k < extra; ++k) scene.find({pose, next}, 0.002, 1);
      pose = next;
    }
    return all;
  };
  const auto one = run(0), other = run(1);
  for (std::size_t i = 0; i < one.size(); ++i) {
    REQUIRE(one[i].contacts.size() == other[i].contacts.size());
    for (std::size_t k = 0; k < one[i].contacts.size(); ++k) {
      const Contact &a = one[i].contacts[k], &b = other[i].contacts[k];
      CHECK(a.triangle == b.triangle);
      CHECK(a.organ == b.organ);
      CHECK(a.gap == b.gap);
      CHECK(a.point_P == b.point_P);
      CHECK(a.normal_P == b.normal_P);
      CHECK(a.barycentric == b.barycentric);
    }
  }
}

TEST_CASE("contact finder: the numbering of triangles changes no place") {
  // Oracle: invariant under permutation.
  RandomShapes random(14);
  const auto ball = random.deformed_ball(0.05, 3);
  auto reversed = ball;
  std::reverse(reversed.triangles.begin(), reversed.triangles.end());
  FinderScene one(ball, scene::SphereShape{}), other(reversed, scene::SphereShape{});
  auto a = one.find(resting({0.01, 0, 0.055}), 0.003).contacts;
  auto b = other.find(resting({0.01, 0, 0.055}), 0.003).contacts;
  REQUIRE(a.size() == b.size());
  const auto by_gap = [](const Contact& x, const Contact& y) { return x.gap < y.gap; };
  std::sort(a.begin(), a.end(), by_gap);
  std::sort(b.begin(), b.end(), by_gap);
  for (std::size_t i = 0; i < a.size(); ++i) CHECK(a[i].gap == Approx(b[i].gap).margin(1e-15));
}

TEST_CASE("contact finder: a plane tells of every node it touches, however many") {
  // Oracle: brute force over the nodes.
  const auto ball = geometry::make_ball(0.05, 5);  // 10242 nodes
  FinderScene scene(ball, scene::PlaneShape{});
  const Quat down(Eigen::AngleAxisd(M_PI, Vec3::UnitX()));
  ContactSet found;
  scene.finder.find(0, {at({0, 0, 0.06}, down), at({0, 0, 0.03}, down)}, 0.002, {10, 1, 10'000},
                    found);
  CHECK_FALSE(found.truncated);
  CHECK(found.contacts.empty());
  REQUIRE(found.faces.size() == 1);
  std::set<std::uint32_t> above;
  for (std::uint32_t i = 0; i < ball.nodes.size(); ++i) {
    if (0.03 - ball.nodes[i][2] <= 0.002) above.insert(i);
  }
  CHECK(above.size() > kMost.contacts);
  CHECK(std::set(found.face_nodes.begin(), found.face_nodes.end()) == above);
  CHECK(found.face_nodes.size() == above.size());
  CHECK(found.deepest_gap() == Approx(-0.02).margin(1e-12));
}

TEST_CASE("contact finder: a list that is too long keeps the deepest and says so") {
  // Oracle: the same search without a limit, sorted.
  const auto ball = geometry::make_ball(0.05, 4);
  const geometry::ProbeForm small = geometry::make_ball(0.01, 2);
  FinderScene all({ball}, {small}), few({ball}, {small});
  const ProbeMotion motion = resting({0, 0, 0.055});
  ContactSet unlimited, limited;
  all.finder.find(0, motion, 0.002, {100'000, 0, 0}, unlimited);
  few.finder.find(0, motion, 0.002, {20, 0, 0}, limited);
  CHECK_FALSE(unlimited.truncated);
  CHECK(limited.truncated);
  REQUIRE(limited.contacts.size() == 20);
  std::vector<double> gaps;
  for (const Contact& c : unlimited.contacts) gaps.push_back(c.gap);
  REQUIRE(gaps.size() > 40);
  std::sort(gaps.begin(), gaps.end());
  for (const Contact& c : limited.contacts) CHECK(c.gap <= gaps[19]);
}

TEST_CASE(
    "contact finder: of a finely meshed wall the nearest part pushes a deep core straight out") {
  // Oracle: analytic; the centre is 10 mm behind a flat wall, where it slides to and fro.
  for (const bool is_fine : {false, true}) {
    FinderScene scene(slab(0.05, is_fine ? 150 : 10), scene::SphereShape{0.006});
    Pose last = at({0, 0, 0.007});
    for (int k = 0; k < 60; ++k) {
      const Vec3 aside(0.004 * (k % 10 < 5 ? k % 5 : 5 - k % 5), 0.001 * (k % 7), 0);
      const Pose now = at(aside - Vec3(0, 0, std::min(0.01, 0.001 * k - 0.006)));
      const ContactSet found = scene.find({last, now}, 0.002);
      last = now;
      if (k < 17) continue;
      CHECK(scene.report.wall_was_cut == is_fine);
      CHECK_FALSE(scene.report.was_lost);
      CHECK(found.contacts.size() >= (is_fine ? kMostOfRound : 1));
      CHECK(deepest_gap(found) == Approx(-0.016).margin(1e-5));
      for (const Contact& c : found.contacts) CHECK(normal_W(found, c).z() == Approx(1));
    }
  }
}

TEST_CASE("contact finder: poses and positions that are not finite give no contacts") {
  // Oracle: invariant.
  FinderScene scene(slab(), scene::SphereShape{});
  const Vec3 touching(0, 0, 0.005);
  CHECK_FALSE(scene.find(resting(touching), 0.002).contacts.empty());
  ProbeMotion bad = resting(touching);
  bad.pose_t1.position[1] = NAN;
  CHECK(scene.find(bad, 0.002).contacts.empty());
  bad = resting(touching);
  bad.pose_t0.rotation.coeffs()[0] = INFINITY;
  CHECK(scene.find(bad, 0.002).contacts.empty());
  bad = resting(touching);
  bad.pose_t1.rotation.coeffs().setZero();
  CHECK(scene.find(bad, 0.002).contacts.empty());
  auto nodes = scene.organs[0].nodes;
  nodes[3][0] = NAN;
  scene.finder.update_organ(0, nodes);
  CHECK(scene.find(resting(touching), 0.002).contacts.empty());
  scene.update();
  CHECK_FALSE(scene.find(resting(touching), 0.002).contacts.empty());
}

TEST_CASE("contact finder: degenerate triangles and an organ without positions are left out") {
  // Oracle: invariant; the same contacts as without the degenerate ones.
  auto with = slab();
  with.nodes.push_back({0, 0, 0});
  const auto extra = static_cast<std::uint32_t>(with.nodes.size() - 1);
  with.triangles.push_back({extra, extra, extra});
  with.triangles.push_back({0, extra, extra});
  FinderScene one(slab(), scene::SphereShape{}), other(with, scene::SphereShape{});
  const Vec3 touching(0.001, 0.0003, 0.005);
  CHECK(one.find(resting(touching), 0.002).contacts.size() ==
        other.find(resting(touching), 0.002).contacts.size());
  ContactFinder empty({slab().triangles, {}}, {probe_of(scene::SphereShape{})});
  ContactSet result;
  empty.find(0, resting(touching), 0.002, kMost, result);
  CHECK(result.contacts.empty());
  empty.update_organ(1, {});
  empty.find(0, resting(touching), 0.002, kMost, result);
  CHECK(result.contacts.empty());
}

TEST_CASE("contact finder: the result names its probe and the pose it holds for") {
  // Oracle: analytic.
  FinderScene scene({slab()}, {probe_of(scene::SphereShape{}), probe_of(scene::BoxShape{})});
  const ProbeMotion motion{at({0, 0, 0.1}), at({0, 0, 0.09})};
  const ContactSet result = scene.find(motion, 0.001, 1);
  CHECK(result.probe == 1);
  CHECK(result.probe_pose.position == motion.pose_t1.position);
  CHECK_FALSE(result.truncated);
}

}  // namespace palpate::collision
