#include "deformation/force_error.h"

#include <catch2/catch.hpp>
#include <string>

#include "deformation/contact/touch_follower.h"
#include "deformation/elements/linear_tetrahedra.h"
#include "deformation/elements/quadrature.h"
#include "deformation/models.h"
#include "deformation/world.h"
#include "tests/deformation/steppers/tetrahedral_solids.h"

using namespace palpate;
using namespace palpate::deformation;

namespace {

constexpr double kSide = 0.06;  // of the cube [m]

OrganModel cube_of(const char* model, int cells) {
  return testing::cube_model(testing::solid_organ(model, 0.49), Vec3::Zero(), cells);
}

TouchedPart all_of_it() { return {Vec3::Constant(kSide / 2), 1, 0.01, 0}; }

std::vector<Vec3> moved(const OrganModel& model, const std::function<Vec3(const Vec3&)>& motion) {
  std::vector<Vec3> positions;
  for (const Vec3& X : model.rest_positions) positions.push_back(motion(X));
  return positions;
}

/// Two waves of shear of 5 % along a cube's side, which keep its volume.
struct Waves {
  static constexpr double kShear = 0.05, kWaveNumber = 2 * std::numbers::pi / kSide;

  static Vec3 at(const Vec3& X) {
    const double a = kShear / kWaveNumber;
    return {X.x() + a * std::sin(kWaveNumber * X.y()), X.y() + a * std::sin(kWaveNumber * X.z()),
            X.z()};
  }
  static Mat3 gradient(const Vec3& X) {
    Mat3 F = Mat3::Identity();
    F(0, 1) = kShear * std::cos(kWaveNumber * X.y());
    F(1, 2) = kShear * std::cos(kWaveNumber * X.z());
    return F;
  }
};

/// ∫ ‖∇x − F‖² and ∫ ‖∇x‖² − 3 of the waves' interpolant on linear tetrahedra.
struct Measured {
  double error = 0, energy = 0;
};
Measured measured(const OrganModel& model, const std::vector<Vec3>& positions) {
  const LinearTetrahedra t(model.rest_positions, model.mesh().tetrahedra);
  Measured sum;
  for (std::size_t e = 0; e < t.size(); ++e) {
    const Mat3 F = t.deformation_gradient(e, positions);
    for (const TetrahedronPoint& point : fourteen_point_rule()) {
      Vec3 X = Vec3::Zero();
      for (std::size_t k = 0; k < 4; ++k) {
        X +=
            point.barycentric[static_cast<Eigen::Index>(k)] * model.rest_positions[t.corners[e][k]];
      }
      const Mat3 exact = Waves::gradient(X);
      sum.error += point.weight * t.volumes[e] * (exact - F).squaredNorm();
      sum.energy += point.weight * t.volumes[e] * (exact.squaredNorm() - 3);
    }
  }
  return sum;
}

}  // namespace

TEST_CASE("force error: tissue strained evenly has none, on linear and on quadratic meshes") {
  // Oracle: both meshes hold it exactly. Rounding: squares of 1e-16 over strains' squares of 1e-2.
  Mat3 F;
  F << 1.1, 0.05, 0, -0.02, 0.95, 0.1, 0, 0.03, 0.96;
  for (const char* name : {"nodal_pressure", "quadratic_pressure"}) {
    INFO(name);
    const OrganModel cube = cube_of(name, 3);
    const auto positions = moved(cube, [&](const Vec3& X) -> Vec3 { return F * X; });
    CHECK(estimated_force_error(cube, positions, all_of_it()) < 1e-25);
    CHECK(estimated_force_error(cube, cube.rest_positions, all_of_it()) == 0);
  }
}

TEST_CASE("force error: of waves of shear it is the share of energy that a linear mesh errs by") {
  // Oracle: quadrature of the exact strains. The estimate is exact in the limit of small edges
  // where each corner has tetrahedra all around (Zienkiewicz and Zhu 1987); of a cube of ten cells
  // a side half the nodes lie on the surface, where the mean is that of one side alone.
  const OrganModel cube = cube_of("nodal_pressure", 10);
  const auto positions = moved(cube, Waves::at);
  const Measured sum = measured(cube, positions);
  const double estimate = estimated_force_error(cube, positions, all_of_it());
  CHECK(estimate / (sum.error / sum.energy) == Approx(1).margin(0.3));
}

TEST_CASE(
    "force error: an edge half as long leaves a quarter of it at most, a quadratic mesh less "
    "still") {
  // Oracle: strains of linear elements are wrong by O(h), of quadratic ones by O(h²), their squares
  // by O(h²) and O(h⁴).
  const auto of = [](const char* name, int cells) {
    const OrganModel cube = cube_of(name, cells);
    return estimated_force_error(cube, moved(cube, Waves::at), all_of_it());
  };
  const double coarse = of("nodal_pressure", 6), fine = of("nodal_pressure", 12);
  CHECK(coarse / fine > 4);
  CHECK(of("quadratic_pressure", 3) < coarse);
  CHECK(of("quadratic_pressure", 3) / of("quadratic_pressure", 6) > 8);
}

TEST_CASE(
    "force error: a round probe smaller than the edges is not believed, whatever strains say") {
  // Oracle: the rule of touch_follower.h, for edges over radius; 1 is the greatest that is said.
  const OrganModel cube = cube_of("nodal_pressure", 10);
  const auto positions = moved(cube, Waves::at);
  TouchedPart part = all_of_it();
  part.probe_radius = part.edge / 1.2;
  CHECK(estimated_force_error(cube, positions, part) == Approx(force_error_of_edge(1.2)));
  part.probe_radius = part.edge / 10;
  CHECK(estimated_force_error(cube, positions, part) == 1);
}

TEST_CASE("force error: a probe that presses a solid has one, of where and how far it presses") {
  // Oracle: the probe's own place; one that is away has none, nor one on a model that is off by
  // more than its mesh.
  const std::string model = GENERATE("nodal_pressure", "corotational", "xpbd_tetrahedra");
  INFO(model);
  scene::Scene scene;
  scene.organs.push_back(testing::solid_organ(model, 0.49));
  scene.organs[0].tissue.drag = 40;
  scene.organs[0].fixed = {scene::BoxRegion{Vec3(-1, -1, -1), Vec3(1, 1, 1e-3)}};
  scene.probes.push_back({"tip", scene::SphereShape{0.01}, 0.0, scene::ScriptedDevice{}});
  DeformationWorld world(
      scene, {geometry::shape_of(geometry::testing::block(Vec3::Constant(kSide), 6, 6, 6))});
  CHECK(world.estimated_force_error(0) == 0);
  const Vec3 top(kSide / 2, kSide / 2, kSide);
  const double depth = 2e-3;
  world.set_probe(0, {top + Vec3(0, 0, 0.01 - depth), Quat::Identity()});
  ContactSet contacts;
  contacts.probe_pose = {top + Vec3(0, 0, 0.01 - depth), Quat::Identity()};
  const auto& triangles = world.model(0).triangles;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const Vec3& x = world.model(0).rest_positions[triangles[t][static_cast<std::size_t>(k)]];
      if ((x - top).norm() > 1e-9 || !contacts.empty()) continue;
      contacts.contacts.push_back({0, t, Vec3::Unit(k), Vec3(0, 0, -0.01), Vec3::UnitZ(), -depth});
    }
  }
  REQUIRE(contacts.count() == 1);
  for (int i = 0; i < 20; ++i) {
    world.set_contacts(contacts);
    world.advance(0.01);
  }
  REQUIRE(world.force(0).z() > 0);
  const double error = world.estimated_force_error(0);
  if (!row_of(model).tells_mesh_error) {
    CHECK(model != "nodal_pressure");
    CHECK(error == 0);
    return;
  }
  CHECK(error > 0.1);  // one node and its neighbours bear a sphere of one edge's size
  CHECK(error <= 1);
}
