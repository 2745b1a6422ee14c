#include "visualizer/shape_measures.h"

#include <catch2/catch.hpp>

#include "modules/geometry/primitives.h"
#include "tests/visualizer/fake_session.h"

using namespace palpate;
using namespace palpate::visualizer;
using visualizer::testing::flat;

namespace {

struct Shape {
  std::vector<float> rest, now;
  std::vector<TriangleIndices> triangles;
};

/// A ball and its image under `map`.
template <class Map>
Shape ball_under(const Map& map) {
  const auto ball = geometry::make_ball(0.05, 2);
  std::vector<Vec3> moved;
  for (const Vec3& p : ball.nodes) moved.push_back(map(p));
  return {flat(ball.nodes), flat(moved), ball.triangles};
}

// Positions are float: 6e-8 of 0.05 m over edges of about 1 cm, doubled by the square root.
constexpr double kFloatStrain = 5e-6;

}  // namespace

TEST_CASE("strain: a uniformly scaled mesh has |s - 1| everywhere", "[visualizer][analytic]") {
  // Oracle: analytic.
  for (const double s : {0.7, 1.0, 1.25}) {
    const Shape shape = ball_under([&](const Vec3& p) { return Vec3(s * p); });
    std::vector<float> strains, at_nodes;
    triangle_strains(shape.rest, shape.now, shape.triangles, strains);
    REQUIRE(strains.size() == shape.triangles.size());
    for (const float strain : strains)
      CHECK(strain == Approx(std::abs(s - 1)).margin(kFloatStrain));
    average_to_nodes(shape.rest, shape.triangles, strains, at_nodes);
    for (const float strain : at_nodes) {
      CHECK(strain == Approx(std::abs(s - 1)).margin(kFloatStrain));
    }
  }
}

TEST_CASE("strain: a rigid motion gives none", "[visualizer][analytic]") {
  // Oracle: invariant.
  const Eigen::AngleAxisd turn(0.8, Vec3(1, 2, 3).normalized());
  const Shape shape = ball_under([&](const Vec3& p) { return Vec3(turn * p + Vec3(0.1, 0, 0.2)); });
  std::vector<float> strains;
  triangle_strains(shape.rest, shape.now, shape.triangles, strains);
  // The shift to 0.2 m costs digits: 1.5e-8 m of rounding over 1 cm edges, twice.
  for (const float strain : strains) CHECK(strain < 1e-5);
}

TEST_CASE("strain: a triangle stretched one way and sheared", "[visualizer][analytic]") {
  // Oracle: analytic. F = diag(1.3, 0.9): larger principal strain 0.3. Simple shear by g: the
  // stretches are sqrt(1 + g²/4) ± g/2.
  const std::vector<float> rest{0, 0, 0, 1, 0, 0, 0.3f, 1, 0};
  const std::vector<TriangleIndices> one{{0, 1, 2}};
  std::vector<float> strains;
  triangle_strains(rest, std::vector<float>{0, 0, 0, 1.3f, 0, 0, 0.39f, 0.9f, 0}, one, strains);
  CHECK(strains[0] == Approx(0.3).epsilon(1e-5));
  const double g = 0.4;
  const std::vector<float> sheared{0, 0, 0, 1, 0, 0, float(0.3 + g), 1, 0};
  triangle_strains(rest, sheared, one, strains);
  CHECK(strains[0] == Approx(std::sqrt(1 + g * g / 4) + g / 2 - 1).epsilon(1e-5));
}

TEST_CASE("strain: a triangle without area at rest has none", "[visualizer]") {
  // Oracle: the stated rule; nothing not finite reaches the colours.
  const std::vector<TriangleIndices> two{{0, 1, 2}, {0, 0, 0}};
  const std::vector<float> line{0, 0, 0, 1, 0, 0, 2, 0, 0};
  const std::vector<float> moved{0, 0, 0, 1, 1, 0, 2, 0, 5};
  std::vector<float> strains, at_nodes;
  triangle_strains(line, moved, two, strains);
  CHECK(strains == std::vector<float>{0, 0});
  average_to_nodes(line, two, strains, at_nodes);
  CHECK(at_nodes == std::vector<float>{0, 0, 0});
}

TEST_CASE("displacement: a shift moves every node by its length", "[visualizer][analytic]") {
  // Oracle: analytic; 3-4-12-13.
  const Shape shape = ball_under([](const Vec3& p) { return Vec3(p + Vec3(3e-3, 4e-3, 12e-3)); });
  std::vector<float> displacements;
  node_displacements(shape.rest, shape.now, displacements);
  REQUIRE(displacements.size() == shape.rest.size() / 3);
  for (const float d : displacements) CHECK(d == Approx(13e-3).epsilon(1e-5));
}

TEST_CASE("normals: on a ball they point outward along the radius", "[visualizer][analytic]") {
  // Oracle: analytic. On a ball subdivided twice (162 nodes) the area-weighted mean of the
  // adjacent triangles leans by less than 3 degrees: their own normals by at most half an edge, 9.
  const Shape shape = ball_under([](const Vec3& p) { return p; });
  std::vector<float> normals;
  node_normals(shape.rest, shape.triangles, normals);
  REQUIRE(normals.size() == shape.rest.size());
  for (std::size_t i = 0; i < normals.size(); i += 3) {
    const Vec3 radial = Vec3(shape.rest[i], shape.rest[i + 1], shape.rest[i + 2]).normalized();
    const Vec3 normal(normals[i], normals[i + 1], normals[i + 2]);
    CHECK(normal.norm() == Approx(1).epsilon(1e-5));
    CHECK(normal.dot(radial) > std::cos(3 * 3.14159 / 180));
  }
}
