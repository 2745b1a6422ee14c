#include "collision/front_contacts.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "collision/core_contacts.h"
#include "collision/core_wall.h"
#include "collision/probe_model.h"
#include "modules/geometry/primitives.h"
#include "modules/scene/probe_shape.h"
#include "tests/collision/random_shapes.h"

namespace palpate::collision {
namespace {

constexpr double kMargin = 0.004;
const ContactLimits kLimits{kUsualContacts, 0, 0};

ContactSet reduced(std::vector<FoundContact> found) {
  ContactSet result;
  reduce_contacts(found, true, kLimits, result);
  return result;
}

bool same_contacts(const ContactSet& one, const ContactSet& other) {
  return std::ranges::equal(one.contacts, other.contacts, [](const Contact& a, const Contact& b) {
    return a.organ == b.organ && a.triangle == b.triangle && a.gap == b.gap &&
           a.point_P == b.point_P && a.normal_P == b.normal_P && a.barycentric == b.barycentric;
  });
}

/// A ball of tissue, or a sheet of it, that ripples within the step; some triangles have no area.
struct Tissue {
  geometry::TriangleSurface surface = geometry::make_ball(0.05, 6);
  OrganSurface organ{surface.triangles,
                     geometry::SurfaceBlocks::split(surface.nodes, surface.triangles)};
  std::uint64_t before = 0;

  explicit Tissue(double thickness) {
    for (Vec3& x : surface.nodes) x.z() *= thickness;
    for (std::size_t t = 0; t < surface.triangles.size(); t += 11) {  // no area, or as good as none
      const double apart = t % 2 == 0 ? 0 : 1e-17;
      surface.nodes[surface.triangles[t][1]] =
          surface.nodes[surface.triangles[t][0]] + apart * Vec3(1, -1, 1);
    }
    update();
    before = organ.version();
    for (Vec3& x : surface.nodes) x += 3e-4 * std::sin(90 * x.x()) * Vec3(0.6, 0, 0.8);
    update();
  }
  void update() {
    organ.update(surface.nodes);
    organ.mark_found();
  }
};

}  // namespace

TEST_CASE("front contacts: what the search for a core finds on all of them, to the bit") {
  // Oracle: CoreContacts on the same triangles, swept.
  const ProbeModel probe(scene::form_of(scene::SphereShape{0.008}));
  RandomShapes random(8);
  std::size_t thinned = 0, grazed = 0, behind = 0, in_front = 0;
  for (const double thickness : {1.0, 0.03}) {
    const Tissue tissue(thickness);
    for (int k = 0; k < 60; ++k) {
      const double height = 0.05 * thickness + random.number(k % 3 == 0 ? -0.001 : 0.003, 0.0085);
      const Pose end{Vec3(random.number(-0.01, 0.01), random.number(-0.01, 0.01), height),
                     random.rotation()};
      const double fast = k % 2 == 0 ? 0.0003 : 0.006;
      const Pose start{end.position + random.point(fast), random.rotation()};
      const RelativeMotion motion({start, end}, probe.reach, probe.is_round);
      const OrganStep step{0, tissue.organ, motion, tissue.before, kMargin, 1};
      NearSurface near;
      if (!near.gather_front(step, probe.cores[0], kMargin)) continue;
      FrontContacts front;
      std::vector<FoundContact> found, all;
      const bool is_in_front = front.find(step, probe.cores[0], near, found);
      near.sweep_candidates(step);
      CoreContacts cores;
      cores.begin_step();
      cores.find(step, probe.cores[0], near.triangles(), all);
      std::vector<std::uint32_t> held;
      cores.begin_step();
      cores.append_held(0, held);
      if (!is_in_front) {
        ++behind;
        CHECK(found.empty());
        CHECK(std::ranges::any_of(near.triangles(), [&](const SweptTriangle& t) {
          return closest(probe.cores[0], t.end).distance <=
                 near.travel() + motion.chord_error() + kSteadyDistance;
        }));
        continue;
      }
      ++in_front;
      CHECK(held.empty());
      thinned += found.size() < all.size();
      const std::size_t grazes =
          std::ranges::count_if(all, [](const FoundContact& c) { return c.normal_P.z() < 0; });
      grazed += grazes > 0;
      CHECK(same_contacts(reduced(found), reduced(all)));
    }
  }
  UNSCOPED_INFO("thinned " << thinned << ", grazed " << grazed << ", behind " << behind
                           << ", in front " << in_front);
  CHECK(thinned > 20);
  CHECK(grazed > 5);
  CHECK(behind > 5);
  CHECK(in_front > 40);
}

}  // namespace palpate::collision
