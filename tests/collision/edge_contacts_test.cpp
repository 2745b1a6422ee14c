#include "collision/edge_contacts.h"

#include <catch2/catch.hpp>
#include <numeric>
#include <set>

#include "tests/collision/step_scene.h"

namespace palpate::collision {
namespace {

/// A box organ standing on its edge: the edge along x on top, at height `top`.
geometry::TriangleSurface ridge(double top) {
  auto box = geometry::make_box({4, 1, 1});
  const Quat tilt(Eigen::AngleAxisd(M_PI / 4, Vec3::UnitX()));
  for (Vec3& x : box.nodes) x = tilt * x + Vec3(0, 0, top - std::sqrt(0.5));
  return box;
}

/// A box probe standing on its edge: the edge along y at the bottom, at height 0.
geometry::TriangleSurface blade() {
  auto box = geometry::make_box({1, 4, 1});
  const Quat tilt(Eigen::AngleAxisd(M_PI / 4, Vec3::UnitY()));
  for (Vec3& x : box.nodes) x = tilt * x + Vec3(0.1, 0.2, std::sqrt(0.5));
  return box;
}

std::vector<FoundContact> find(EdgeContacts& edges, const StepScene& scene,
                               const SharpMesh& probe) {
  std::vector<std::uint32_t> all(scene.organ.edges().size());
  std::iota(all.begin(), all.end(), 0u);
  std::vector<FoundContact> found;
  edges.begin_step();
  edges.find(scene.step, probe, {Vec3::Zero(), scene.step.margin}, all, found);
  return found;
}

}  // namespace

TEST_CASE("edge contacts: two crossed edges have one contact, where they are closest") {
  // Oracle: analytic.
  const SharpMesh probe(blade());
  EdgeContacts edges;
  const auto found = find(edges, StepScene(ridge(-0.05), Vec3::Zero()), probe);
  REQUIRE(found.size() == 1);
  CHECK(found[0].gap == Approx(0.05).margin(1e-12));
  CHECK((found[0].normal_P - Vec3::UnitZ()).norm() < 1e-9);
  CHECK((found[0].point_P - Vec3(0.1, 0, 0)).norm() < 1e-9);
  CHECK(find(edges, StepScene(ridge(-0.15), Vec3::Zero()), probe).empty());
}

TEST_CASE("edge contacts: edges that touch are in contact, whatever rounding makes of it") {
  // Oracle: analytic; resting edges came and went from search to search.
  const SharpMesh probe(blade());
  for (const double gap : {0.0, 1e-15, 1e-12, 1e-10}) {
    INFO(gap);
    EdgeContacts edges;
    const auto found = find(edges, StepScene(ridge(-gap), Vec3::Zero()), probe);
    REQUIRE(found.size() == 1);
    CHECK(found[0].gap == Approx(gap).margin(1e-14));
    CHECK((found[0].normal_P - Vec3::UnitZ()).norm() < 1e-9);
  }
}

TEST_CASE("edge contacts: edges that passed through each other keep their sides") {
  // Oracle: analytic.
  const SharpMesh probe(blade());
  EdgeContacts edges;
  const auto crossed = find(edges, StepScene(ridge(0.2), {0, 0, 0.5}), probe);
  REQUIRE(crossed.size() == 1);
  CHECK(crossed[0].gap == Approx(-0.2).margin(1e-12));
  CHECK((crossed[0].normal_P - Vec3::UnitZ()).norm() < 1e-9);
  const auto held = find(edges, StepScene(ridge(0.25), {0, 0, 0.05}), probe);
  REQUIRE(held.size() == 1);
  CHECK(held[0].gap == Approx(-0.25).margin(1e-12));
  edges.reset();
  CHECK(find(edges, StepScene(ridge(0.25), Vec3::Zero()), probe).empty());
}

TEST_CASE("edge contacts: edges that crossed and slid off each other are found by their crossing") {
  // Oracle: analytic; the way ends where the edges no longer lie over each other.
  const SharpMesh probe(blade());
  auto organ = ridge(0.2);
  for (Vec3& x : organ.nodes) x += Vec3(0, 3, 0);  // beside the end of the blade's edge at y = 2.2
  EdgeContacts edges;
  const auto found = find(edges, StepScene(organ, {0, 3, 0.5}), probe);
  REQUIRE_FALSE(found.empty());
  CHECK(found[0].gap == Approx(-0.2).margin(1e-6));
  CHECK(found[0].normal_P[2] > 0.99);
}

TEST_CASE("edge contacts: a flat diagonal is no ridge, a far edge seen from inside no contact") {
  // Oracle: analytic. The organ's edges under the probe lie in a plane, and those on its top face
  // form contacts straight up; the shell's bottom, seen from inside, forms none.
  const SharpMesh probe(blade());
  EdgeContacts edges;
  for (const FoundContact& c :
       find(edges, StepScene(box_at({0, 0, -1.05}, {8, 8, 2}, 2), Vec3::Zero()), probe)) {
    CHECK((c.normal_P - Vec3::UnitZ()).norm() < 1e-9);
    CHECK(c.gap == Approx(0.05).margin(1e-12));
  }
  CHECK(
      find(edges, StepScene(box_at({0, 0, 2 - 0.05}, {8, 8, 4}, 2), Vec3::Zero()), probe).empty());
}

TEST_CASE("edge contacts: of rough surfaces every pair that faces each other is found") {
  // Oracle: brute force over all pairs, for tissue and a probe that nearly touch.
  RandomShapes random(41);
  std::size_t all = 0;
  for (int trial = 0; trial < 40; ++trial) {
    const double margin = random.number(0.3, 1.5);
    auto tissue = random.deformed_ball(1, 2);
    for (Vec3& x : tissue.nodes) x += Vec3(0, 0, -2.15) + random.point(0.06);
    auto form = random.deformed_ball(1, 2);
    for (Vec3& x : form.nodes) x += random.point(0.06);
    const StepScene scene(tissue, Vec3::Zero(), margin);
    const SharpMesh probe(form);
    EdgeContacts edges;
    std::set<std::pair<double, double>> found, brute;
    for (const FoundContact& c : find(edges, scene, probe)) found.insert({c.gap, c.point_P.x()});
    for (const SharpEdge& sharp : probe.edges()) {
      const Vec3 &a = form.nodes[sharp.vertices[0]], &b = form.nodes[sharp.vertices[1]];
      for (const SurfaceEdge& edge : scene.organ.edges()) {
        const Vec3 c = scene.step.node_end(edge.nodes[0]), d = scene.step.node_end(edge.nodes[1]);
        const auto at = geometry::closest_of_segments(a, b, c, d);
        const Vec3 apart = at.on_first - at.on_second;
        if (apart.norm() > margin || std::min({at.s, at.t, 1 - at.s, 1 - at.t}) <= 1e-9) continue;
        // Nearest to each other of all of both their triangles, and seen from outside.
        bool faces = true;
        for (int k = 0; k < 2; ++k) {
          faces = faces && -apart.normalized().dot(sharp.into_face[k]) <= kConeSlack;
          faces = faces && -apart.dot(sharp.face_normals[k]) > 0;
          const geometry::Triangle& t = scene.organ.triangles()[edge.triangles[k]];
          const geometry::TriangleCorners x{scene.step.node_end(t[0]), scene.step.node_end(t[1]),
                                            scene.step.node_end(t[2])};
          faces = faces && apart.dot(geometry::unit_normal(x)) > 0;
          for (const Vec3& corner : x) {
            if (corner == c || corner == d) continue;
            const Vec3 along = (d - c).normalized(), in = corner - c;
            const Vec3 into = (in - along * along.dot(in)).normalized();
            faces = faces && apart.normalized().dot(into) <= kConeSlack;
          }
        }
        if (faces) brute.insert({apart.norm(), at.on_first.x()});
      }
    }
    CHECK(found == brute);
    all += brute.size();
  }
  CHECK(all > 30);
}

}  // namespace palpate::collision
