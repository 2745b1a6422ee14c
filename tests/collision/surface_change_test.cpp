#include "collision/surface_change.h"

#include <catch2/catch.hpp>

#include "modules/geometry/bisection.h"
#include "modules/geometry/organ_shape.h"
#include "tests/collision/finder_scene.h"
#include "tests/modules/geometry/tetrahedra.h"

namespace palpate::collision {
namespace {

geometry::TriangleSurface skin_of_block(const Vec3& fine_at, double edge) {
  return geometry::shape_of(geometry::bisected(
                                geometry::testing::block({0.08, 0.08, 0.04}, 4, 4, 2),
                                [&](const Vec3& x) { return edge + 0.5 * (x - fine_at).norm(); },
                                50'000))
      .surface;
}

/// A finder whose organ gets other triangles.
struct ChangingScene : FinderScene {
  using FinderScene::FinderScene;

  void change(geometry::TriangleSurface surface) {
    finder.change_organ(0, surface.triangles, {}, organs[0].nodes, surface.nodes);
    organs[0] = std::move(surface);
    update();
  }
};

const geometry::TriangleSurface kCoarseSkin = skin_of_block({0, 0, 0}, 1);
const geometry::TriangleSurface kFineSkin = skin_of_block({0.04, 0.04, 0.04}, 5e-3);

TEST_CASE("surface change: a probe behind a wall is pushed out the way it came, on any triangles") {
  // Oracle: it came from above and is nearer to the bottom: who had not seen it come would push it
  // down. Finer, coarser, and to and fro.
  constexpr double kDeep = 0.012;  // height above the bottom; the block is 0.04 high
  for (const scene::ProbeShape& shape : {scene::ProbeShape(scene::SphereShape{1e-3}),
                                         scene::ProbeShape(scene::CapsuleShape{1e-3, 0.06}),
                                         scene::ProbeShape(scene::ConeShape{2e-3, 0.06})}) {
    const Vec3 above(0.043, 0.041, 0.09), inside(0.043, 0.041, kDeep + 0.03);
    const Vec3 drop(0, 0, scene::ProbeShape(shape).index() == 1 ? 0 : -0.03);
    ChangingScene scene(kCoarseSkin, shape);
    scene.find(resting(above), 1e-3);
    scene.find({at(above), at(inside + drop)}, 1e-3);
    for (const auto* skin : {&kFineSkin, &kCoarseSkin, &kFineSkin}) {
      scene.change(*skin);
      const ContactSet found = scene.find(resting(inside + drop), 1e-3);
      INFO("shape " << shape.index());
      REQUIRE_FALSE(found.contacts.empty());
      CHECK_FALSE(scene.report.begun_inside);
      CHECK_FALSE(scene.report.was_lost);
      int deep = 0;  // of the tip; a shaft is beside the wall that it goes through
      for (const Contact& contact : found.contacts) {
        if (contact.gap > -5e-3) continue;
        ++deep;
        CHECK(normal_W(found, contact).z() > 0.9);
      }
      CHECK(deep > 0);
    }
  }
}

TEST_CASE("surface change: what rests on tissue finds what a finder of the new triangles finds") {
  // Oracle: a finder that never knew others.
  const scene::SphereShape ball{8e-3};
  const Vec3 pressed(0.041, 0.043, 0.04 + 7e-3);
  ChangingScene scene(kCoarseSkin, ball);
  scene.find(resting(pressed), 1e-3);
  scene.change(kFineSkin);
  const ContactSet changed = scene.find(resting(pressed), 1e-3);
  FinderScene fresh(kFineSkin, ball);
  const ContactSet expected = fresh.find(resting(pressed), 1e-3);
  REQUIRE(changed.contacts.size() == expected.contacts.size());
  CHECK(changed.contacts.size() > 4);
  for (std::size_t i = 0; i < expected.contacts.size(); ++i) {
    CHECK(changed.contacts[i].triangle == expected.contacts[i].triangle);
    CHECK(changed.contacts[i].gap == expected.contacts[i].gap);
  }
}

TEST_CASE("surface change: tissue that moves meanwhile is where its triangles were") {
  // Oracle: an affine motion, under which any triangles of the same faces lie alike.
  Mat3 F;
  F << 1.1, 0.1, 0, 0, 0.9, 0.2, 0.1, 0, 1;
  OrganSurface coarse(kCoarseSkin.triangles), fine(kFineSkin.triangles);
  std::vector<Vec3> moved;
  for (const Vec3& x : kCoarseSkin.nodes) moved.push_back(F * x);
  coarse.update(moved);
  const geometry::SurfaceTransfer back(kFineSkin.nodes, kFineSkin.triangles, kCoarseSkin.nodes,
                                       kCoarseSkin.triangles);
  const auto carried = carried_positions(coarse, fine, back);
  REQUIRE(carried.size() == kFineSkin.nodes.size());
  for (std::size_t i = 0; i < carried.size(); ++i) {
    CHECK((carried[i] - F * kFineSkin.nodes[i]).norm() < 1e-15);
  }
}

}  // namespace
}  // namespace palpate::collision
