// What a search of a finely meshed tool finds where it does not look at everything.
#include <catch2/catch.hpp>
#include <numeric>

#include "collision/edge_contacts.h"
#include "tests/collision/finder_scene.h"
#include "tests/collision/step_scene.h"

namespace palpate::collision {
namespace {

geometry::ProbeForm ball_of_triangles(double radius, int halvings) {
  return scene::form_of(scene::MeshShape{}, geometry::make_ball(radius, halvings));
}

}  // namespace

TEST_CASE("search budget: a fine tool is found where it is, ahead, crossed and held") {
  // Oracle: analytic, the distance of two balls; their facets are off by 1e-4 at most.
  constexpr double kOrgan = 0.05, kTool = 0.012, kMargin = 0.02, kFacets = 1e-4;
  const auto expect = [&](FinderScene& scene, const ProbeMotion& motion) {
    const ContactSet found = scene.find(motion, kMargin);
    const Vec3& at = motion.pose_t1.position;
    CHECK(deepest_gap(found) == Approx(at.norm() - kOrgan - kTool).margin(kFacets));
    const auto deepest = std::ranges::min_element(found.contacts, {}, &Contact::gap);
    REQUIRE(deepest != found.contacts.end());
    CHECK(normal_W(found, *deepest).dot(at.normalized()) > 0.99);
    return found.contacts.size();
  };
  FinderScene scene({geometry::make_ball(kOrgan, 4)}, {ball_of_triangles(kTool, 5)});
  const Vec3 along = Vec3(0.3, -0.5, 1).normalized();
  Vec3 at = 0.08 * along;
  expect(scene, resting(at));
  for (const double next : {0.07, 0.058, 0.0565, 0.057, 0.065}) {
    expect(scene, {{at, Quat::Identity()}, {next * along, Quat::Identity()}});
    at = next * along;
  }
  CHECK_FALSE(scene.report.was_lost);
  CHECK_FALSE(scene.report.was_cut);
}

TEST_CASE("search budget: of very many edges those that went through each other are all found") {
  // Oracle: the same search with a margin so small that all pairs are looked at.
  const auto tissue = [] {
    auto ball = geometry::make_ball(1, 5);
    for (Vec3& x : ball.nodes) x = (x + Vec3(0, 0, -1.98)) * (1 + 0.001 * std::sin(300 * x.x()));
    return ball;
  }();
  const SharpMesh probe(geometry::make_ball(1, 5));
  const auto found_within = [&](double margin, EdgeContacts::Searched expected) {
    const StepScene scene(tissue, {0, 0, 0.05}, margin);
    std::vector<std::uint32_t> all(scene.organ.edges().size());
    std::iota(all.begin(), all.end(), 0u);
    std::vector<FoundContact> found;
    EdgeContacts edges;
    edges.begin_step();
    CHECK(edges.find(scene.step, probe, {Vec3::Zero(), margin}, all, found) == expected);
    std::erase_if(found, [](const FoundContact& c) { return c.gap > 0; });
    return found;
  };
  const auto few = found_within(0.001, EdgeContacts::Searched::kAll);
  const auto many = found_within(2, EdgeContacts::Searched::kLessAhead);
  CHECK(few.size() > 10);
  REQUIRE(few.size() == many.size());
  for (std::size_t i = 0; i < few.size(); ++i) CHECK(few[i].point_P == many[i].point_P);
}

TEST_CASE("search budget: of very many triangles those that it comes to as it goes on are found") {
  // Oracle: analytic, the distance of two balls where it goes; and a search that need not be cut.
  constexpr double kOrgan = 0.05, kTool = 0.006, kMargin = 0.1, kWay = 0.045, kFacets = 1e-4;
  FinderScene scene({geometry::make_ball(kOrgan, 6)}, {ball_of_triangles(kTool, 4)});
  const Vec3 along = Vec3(0.3, -0.5, 1).normalized(), at = 0.1 * along;
  ProbeMotion motion = resting(at);
  motion.ahead_W = -kWay * along;
  const ContactSet found = scene.find(motion, kMargin);
  CHECK(scene.report.looked_less_ahead);
  CHECK_FALSE(scene.report.was_cut);
  CHECK(deepest_gap(found) == Approx(0.1 - kOrgan - kTool).margin(kFacets));
  FinderScene coarse({geometry::make_ball(kOrgan, 3)}, {ball_of_triangles(kTool, 1)});
  coarse.find(motion, kMargin);
  CHECK_FALSE(coarse.report.looked_less_ahead);
}

TEST_CASE(
    "search budget: a fine tool deep inside is pushed out by what is nearest to each corner") {
  // Oracle: analytic, balls about one point: every corner is as deep as the organ is thick there.
  constexpr double kOrgan = 0.05, kTool = 0.02;
  FinderScene scene({geometry::make_ball(kOrgan, 5)}, {ball_of_triangles(kTool, 4)});
  const Vec3 at(0, 0, 0.02);
  std::size_t before = 0;
  for (int search = 0; search < 4; ++search) {
    const ContactSet found = scene.find(resting(at), 0.002);
    CHECK(scene.report.begun_inside == (search == 0));
    CHECK(scene.report.wall_was_cut);
    CHECK_FALSE(scene.report.was_lost);
    REQUIRE(found.contacts.size() > 100);
    Vec3 push = Vec3::Zero();
    for (const Contact& c : found.contacts) {
      CHECK(c.gap < 0);
      push += normal_W(found, c);
    }
    // Out the near side; held contacts are the same in the next search.
    CHECK(push.normalized().z() > 0.9);
    if (search > 1) CHECK(found.contacts.size() == before);
    before = found.contacts.size();
  }
  scene.find({palpate::collision::at(at), palpate::collision::at({0, 0, 0.08})}, 0.002);
  scene.find(resting({0, 0, 0.08}), 0.002);
  const ContactSet out = scene.find(resting({0, 0, 0.071}), 0.002);
  CHECK(deepest_gap(out) == Approx(0.001).margin(1e-4));
}

TEST_CASE("search budget: what is past it is said") {
  // Oracle: by construction: a tool of 122,880 edges goes 40 mm into an organ of 30,720.
  FinderScene scene({geometry::make_ball(0.05, 5)}, {ball_of_triangles(0.03, 6)});
  const Quat turned(Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()));
  scene.find(resting({0, 0, 0.09}, turned), 0.005);
  CHECK_FALSE(scene.report.was_cut);
  ContactSet found;
  const ProbeMotion in{at({0, 0, 0.09}, turned), at({0, 0, 0.05}, turned)};
  const SearchReport report = scene.finder.find(0, in, 0.1, kMost, found);
  CHECK(report.was_cut);
  CHECK(found.truncated);
  CHECK(deepest_gap(found) < -0.02);
}

}  // namespace palpate::collision
