#include "studies/plan/candidates.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "modules/core/data_folder.h"
#include "modules/geometry/closest_points.h"
#include "modules/scene/assets.h"
#include "modules/scene/models.h"
#include "modules/scene/scene_reader.h"
#include "studies/plan/probe_paths.h"

namespace palpate::plan {
namespace {

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

TEST_CASE("plan: solids are also tried with small tetrahedra at the places that probes touch") {
  // Oracle: the scene; its fingertip of 8 mm touches the liver's front and slides along it, no
  // region's middle off the skin by more than rounding; a region per 6 mm of way at most.
  const auto scene = scene::load_scene(data_file("scenes/liver_solid.yaml"));
  const auto skin = scene::load_skin(scene.organs[0]);
  const ProbePaths paths(scene, skin, 6);
  const auto regions = paths.regions();
  REQUIRE(regions.size() >= 2);
  for (const auto& region : regions) {
    const auto& ball = std::get<scene::SphereRegion>(region);
    CHECK(ball.radius == 8e-3);
    double nearest = 1;
    for (const auto& [a, b, c] : skin.triangles) {
      const geometry::TriangleCorners corners{skin.nodes[a], skin.nodes[b], skin.nodes[c]};
      const Vec3 point = geometry::closest_on_triangle(ball.center, corners).point;
      nearest = std::min(nearest, (point - ball.center).norm());
    }
    CHECK(nearest < 1e-9);
  }
  std::size_t refined = 0;
  for (const Candidate& candidate : candidates_of(scene, regions, paths.smallest_radius())) {
    if (candidate.refine.near.empty()) continue;
    ++refined;
    CHECK(candidate.refine.near.size() == regions.size());
    const auto planned = scene_with(scene, candidate);
    CHECK(planned.organs[0].solid.refine.edge_length == candidate.refine.edge_length);
    CHECK_THAT(candidate.name(), Catch::Contains(" mm + "));
  }
  CHECK(refined >= 4);
}

TEST_CASE("plan: what a course takes grows with nodes, rate and smallness of tetrahedra") {
  // Oracle: the order; springs cost less than solids, XPBD of tetrahedra more.
  const double radius = 8e-3;
  const auto refined = [&](double edge, double growth) {
    return weight_of({"nodal_pressure", 136, 100, {}, {{}, edge, growth, true}}, radius);
  };
  const auto plain = [&](const char* model, std::size_t nodes, double rate) {
    return weight_of({model, nodes, rate}, radius);
  };
  CHECK(plain("implicit_volume", 136, 100) < plain("corotational", 136, 100));
  CHECK(plain("corotational", 136, 100) < plain("corotational", 272, 100));
  CHECK(plain("corotational", 136, 100) < plain("corotational", 136, 200));
  CHECK(plain("corotational", 136, 100) < plain("xpbd_tetrahedra", 136, 100));
  CHECK(plain("nodal_pressure", 136, 100) < refined(8e-3, 1));
  CHECK(refined(8e-3, 1) < refined(4e-3, 0.7));
  CHECK(refined(4e-3, 0.7) < refined(4e-3, 0.5));
}

}  // namespace
}  // namespace palpate::plan
