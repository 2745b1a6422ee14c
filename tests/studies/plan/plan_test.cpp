#include "studies/plan/plan.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "haptics/devices/device.h"
#include "modules/core/data_folder.h"
#include "modules/scene/assets.h"
#include "modules/scene/models.h"
#include "modules/scene/scene_reader.h"
#include "studies/plan/solid_reference.h"
#include "tests/modules/geometry/tetrahedra.h"

namespace palpate::plan {
namespace {

Course course_of(double force, double surface) {
  Course course;
  course.forces = {{Vec3(0, 0, 0)}, {Vec3(0, 0, force)}};
  course.surfaces = {{Vec3::Zero(), Vec3::Zero()}, {Vec3(surface, 0, 0), Vec3::Zero()}};
  course.deformation_cost = 0.1;
  course.collision_cost = 0.01;
  return course;
}

TEST_CASE("plan: errors of a course are root mean squares against the reference") {
  // Oracle: by hand.
  const Errors errors = compare(course_of(1.1, 3e-3), course_of(1, 1e-3));
  CHECK(errors.force == Approx(0.1));
  CHECK(errors.surface == Approx(std::sqrt(4e-6 / 4)));
  Course cut = course_of(1, 0);
  cut.forces.pop_back();
  CHECK(std::isinf(compare(cut, course_of(1, 0)).force));
}

TEST_CASE("plan: the cheapest that meets all needs is chosen, and losers know why") {
  // Oracle: by hand.
  scene::Needs needs;
  needs.force_error = 0.2;
  const Course reference = course_of(1, 1e-3);
  Course dear = course_of(1.05, 1e-3), wrong = course_of(1.5, 1e-3), slow = course_of(1, 1e-3);
  dear.deformation_cost = 0.3;
  slow.deformation_cost = 2;
  std::vector<Verdict> verdicts;
  for (const Course& course : {wrong, dear, slow}) {
    verdicts.push_back(judge(needs, {}, course, reference));
  }
  REQUIRE(best(verdicts) == &verdicts[1]);
  CHECK_THAT(verdicts[0].failures.at(0), Catch::Contains("force error 0.5 > 0.2"));
  CHECK_THAT(verdicts[2].failures.at(0), Catch::Contains("load of the core"));
  CHECK(verdicts[1].total_load == Approx(0.31 + needs.haptics_rate * kHapticTick));

  verdicts.erase(verdicts.begin() + 1);
  CHECK(best(verdicts) == nullptr);
  const auto ways = ways_out(needs, verdicts);
  REQUIRE(ways.size() == 2);
  CHECK_THAT(ways[0], Catch::Contains("cores 2.5 times as fast"));
  CHECK_THAT(ways[1], Catch::Contains("force_error 0.5"));
}

TEST_CASE("plan: a candidate is written into the scene explicitly") {
  // Oracle: the fields.
  scene::Scene scene;
  scene.organs.push_back({});
  scene.needs.haptics_rate = 2000;
  const auto planned =
      scene_with(scene, {"nodal_pressure", 500, 400, scene::Integrator::kAutomatic});
  CHECK(planned.organs[0].model == "nodal_pressure");
  CHECK(planned.organs[0].mesh.nodes == 500);
  CHECK(planned.organs[0].solid.poisson_ratio == 0.499);
  CHECK(scene_with(scene, {"corotational", 500, 400}).organs[0].solid.poisson_ratio == 0.45);
  CHECK(planned.rates.deformation == 400);
  CHECK(planned.rates.collision == 400);
  CHECK(planned.rates.haptics == 2000);
}

TEST_CASE("plan: quadratic candidates have as many nodes as the others, not as many corners") {
  // Oracle: the rule; the liver's surface has 544 nodes.
  const auto scene = scene::load_scene(data_file("scenes/liver_solid.yaml"));
  std::size_t most_linear = 0, most_corners = 0;
  for (const Candidate& candidate : candidates_of(scene)) {
    CHECK(candidate.nodes >= 60);
    auto& most = scene::is_quadratic(candidate.model) ? most_corners : most_linear;
    most = std::max(most, candidate.nodes);
  }
  CHECK(most_linear == 2 * 544);
  CHECK(most_corners == 2 * 544 / 4);
}

TEST_CASE("plan: the reference of a solid is fine where the probe goes, and of the same shape") {
  // Oracle: volume; edges touched by the probe, as the device moves it, and far from it.
  constexpr double kDuration = 4;
  if (geometry::testing::without_gmsh()) return;
  auto scene = scene::load_scene(data_file("scenes/liver_solid.yaml"));
  const auto fine = solid_reference_shape(scene, kDuration, kReferenceEdge).surface;
  scene.organs[0].model = "implicit_volume";
  const auto coarse = scene::load_organ(scene.organs[0]).surface;
  CHECK(geometry::enclosed_volume(fine.nodes, fine.triangles) ==
        Approx(geometry::enclosed_volume(coarse.nodes, coarse.triangles)).epsilon(1e-9));
  std::vector<std::string> warnings;
  const auto device = haptics::make_device(scene.probes[0].device, scene.haptics, warnings);
  double longest_near = 0, longest = 0;
  for (const auto& [a, b] : geometry::edges_of(fine.triangles)) {
    const Vec3 middle = (fine.nodes[a] + fine.nodes[b]) / 2;
    const double length = (fine.nodes[a] - fine.nodes[b]).norm();
    longest = std::max(longest, length);
    for (double time = 0; time < kDuration; time += 0.02) {
      const bool near = (device->read(time).pose.position - middle).norm() < 8e-3;
      if (near) longest_near = std::max(longest_near, length);
    }
  }
  CHECK(longest_near > 0);
  CHECK(longest_near < 8e-3);  // 2 mm + 0.4 × (8 mm + half a radius between centres), and some
  CHECK(longest > 12e-3);
}

}  // namespace
}  // namespace palpate::plan
