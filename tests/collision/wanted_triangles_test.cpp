#include "collision/wanted_triangles.h"

#include <catch2/catch.hpp>

#include "collision/probe_model.h"
#include "modules/scene/probe_shape.h"
#include "tests/collision/random_shapes.h"

namespace palpate::collision {

TEST_CASE("wanted triangles: whatever touches in the step is wanted, and boxes and floats agree") {
  // Oracle: the distance of the triangle from the core at points of time of the step.
  RandomShapes random(21);
  int touched = 0, refused = 0, told_by_floats = 0;
  for (int k = 0; k < 4000; ++k) {
    const ProbeModel probe(k % 2 == 0 ? scene::form_of(scene::CapsuleShape{0.004, 0.02})
                                      : scene::form_of(scene::SphereShape{0.008}));
    const Pose start{random.point(0.1), random.rotation()};
    const Quat turn(Eigen::AngleAxisd(random.number(0, 0.2), random.direction()));
    const ProbeMotion way{start, {start.position + random.point(0.005), turn * start.rotation}};
    const RelativeMotion motion(way, probe.reach, probe.is_round);
    const double reach = probe.hull_radius;
    const WantedTriangles wanted(motion, probe.hull, reach);
    told_by_floats += wanted.told_by_floats();
    OrganSurface organ({{0, 1, 2}});
    const Vec3 about = start.position + random.point(0.02);
    std::vector<Vec3> nodes;
    for (int i = 0; i < 3; ++i) nodes.push_back(about + random.point(0.003));
    organ.update(nodes);
    organ.mark_found();
    const std::uint64_t before = organ.version();
    geometry::BlockBox at_start, at_end;
    for (Vec3& x : nodes) {
      at_start.add(x);
      x += random.point(0.002);
      at_end.add(x);
    }
    organ.update(nodes);
    const OrganStep step{0, organ, motion, before, 0, 1};
    std::array<SweptNode, 3> swept;
    std::array<Apart, 3> apart;
    for (std::uint32_t i = 0; i < 3; ++i) {
      const Vec3 end = step.node_end(i);
      swept[i] = {step.node_start(i), end, 0, i, wanted.is_sure(end)};
      apart[i] = wanted.apart(step.start_positions()[i], nodes[i]);
    }
    const bool is = wanted.told_by_floats()
                        ? wanted.is_told(step, {0, 1, 2})
                        : wanted.is(step, {0, 1, 2}, {&swept[0], &swept[1], &swept[2]});
    const bool may_be = wanted.may_be(apart[0], apart[1], apart[2]);
    const bool may_be_in = wanted.may_be_in(motion, at_start, at_end);
    CHECK((!is || may_be));
    CHECK((!is || may_be_in));
    if (wanted.told_by_floats()) CHECK(is == may_be);
    refused += !may_be;
    SweptTriangle triangle;
    if (!step.sweep(0, triangle)) continue;
    bool touches = false;
    for (const double at : {0.0, 0.25, 0.5, 0.75, 1.0}) {
      touches |= closest(probe.cores[0], triangle.at(at)).distance <= reach;
    }
    touched += touches;
    if (touches) CHECK(is);
  }
  CHECK(touched > 100);
  CHECK(refused > 100);
  CHECK(told_by_floats == 2000);
}

TEST_CASE("wanted triangles: of a core without end no block beside it is left out") {
  // Oracle: analytic: a half-space's surface, z = 0 in P.
  const ProbeModel plane(scene::form_of(scene::PlaneShape{}));
  const Pose turned{Vec3(0.1, 0.2, 0.3), Quat(Eigen::AngleAxisd(0.4, Vec3::UnitX()))};
  const RelativeMotion motion({turned, turned}, 0, false);
  const WantedTriangles wanted(motion, plane.hull, 0.01);
  for (const double height : {-0.5, -0.001, 0.009, 0.02}) {
    geometry::BlockBox box;
    const Vec3 at = turned.position + turned.rotation * Vec3(3, -2, height);
    box.add(at);
    CHECK(wanted.may_be_in(motion, box, box) == (height <= 0.01));
  }
}

}  // namespace palpate::collision
