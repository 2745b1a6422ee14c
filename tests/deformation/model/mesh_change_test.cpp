#include "deformation/model/mesh_change.h"

#include <catch2/catch.hpp>
#include <random>

#include "deformation/elements/average_nodal_pressure.h"
#include "tests/deformation/model/mesh_changes.h"
#include "tests/deformation/steppers/tetrahedral_solids.h"

namespace palpate::deformation {
namespace {

using testing::SolidThere;

geometry::OrganShape cube_to_change() {
  return geometry::shape_of(geometry::testing::block(Vec3::Constant(0.06), 4, 4, 4));
}

TouchedPlace touch_at(const Vec3& centre) { return {centre, 8e-3, 5e-3}; }

OrganState carried_linear(const SolidThere& from, const SolidThere& to, const OrganState& state) {
  return MeshChange(from.model, from.refined.parents, to.model, to.refined.parents).carried(state);
}

TEST_CASE("mesh change: momentum stays, kinetic energy never grows, an even motion stays even") {
  const scene::Organ organ = testing::solid_organ("nodal_pressure", 0.499);
  FollowingMesh mesh(cube_to_change(), 0.6, 20000);
  OrganState state;
  std::mt19937 random(12);
  const auto last = testing::change_meshes(
      mesh, organ, 50, 11, touch_at, [&](const SolidThere& from, const SolidThere& to) {
        if (state.positions.empty()) state = rest_state(from.model);
        testing::check_motion_carried(from, to, random, state, [&](const OrganState& s) {
          return carried_linear(from, to, s);
        });
      });
  for (std::size_t i = 0; i < state.positions.size(); ++i) {  // at rest all along
    CHECK((state.positions[i] - last->model.rest_positions[i]).norm() < 1e-16);
  }
}

TEST_CASE("mesh change: a finer mesh is the same shape, and an even strain costs the same energy") {
  // Oracle: an affine map is exact on any mesh: its energy is the same, refined or not, and back.
  const scene::Organ organ = testing::solid_organ("nodal_pressure", 0.499);
  FollowingMesh mesh(cube_to_change(), 0.6, 20000);
  const SolidThere coarse(mesh, {}, organ), fine(mesh, {touch_at({0.02, 0.03, 0.06})}, organ);
  OrganState state = rest_state(coarse.model);
  Mat3 F;
  F << 1.05, 0.1, 0, -0.04, 0.98, 0.06, 0.02, 0, 0.99;
  for (Vec3& x : state.positions) x = F * x;
  const auto energy = [&](const SolidThere& of, const OrganState& at) {
    return AverageNodalPressure(
               LinearTetrahedra(of.model.rest_positions, of.model.mesh().tetrahedra),
               of.model.mesh().elastic())
        .energy(at.positions);
  };
  const OrganState refined = carried_linear(coarse, fine, state);
  for (std::size_t i = 0; i < refined.positions.size(); ++i) {
    CHECK((refined.positions[i] - F * fine.model.rest_positions[i]).norm() < 1e-15);
  }
  CHECK(energy(fine, refined) == Approx(energy(coarse, state)).epsilon(1e-9));
  CHECK(carried_linear(fine, coarse, refined).positions == state.positions);
}

TEST_CASE("mesh change: how far nodes go is carried as where they are") {
  const scene::Organ organ = testing::solid_organ("nodal_pressure", 0.499);
  FollowingMesh mesh(cube_to_change(), 0.6, 20000);
  const SolidThere coarse(mesh, {}, organ), fine(mesh, {touch_at({0.02, 0.03, 0.06})}, organ);
  OrganState state = rest_state(coarse.model);
  state.positions = testing::shaken(coarse.model, 5e-3);
  const MeshChange change(coarse.model, coarse.refined.parents, fine.model, fine.refined.parents);
  testing::check_ways_carried(coarse.model, fine.model, change, state);
}

TEST_CASE("mesh change: pressures of nodes are a piecewise linear function before and after") {
  // Oracle: one that is linear over the whole cube stays so, and comes back to the bit.
  const scene::Organ organ = testing::solid_organ("nodal_pressure", 0.499);
  FollowingMesh mesh(cube_to_change(), 0.6, 20000);
  const SolidThere coarse(mesh, {}, organ), fine(mesh, {touch_at({0.02, 0.03, 0.06})}, organ);
  const auto linear = [](const SolidThere& there) {
    Eigen::VectorXd pressures(static_cast<Eigen::Index>(there.model.node_count()));
    for (Eigen::Index i = 0; i < pressures.size(); ++i) {
      pressures[i] = Vec3(1, -2, 3).dot(there.model.rest_positions[static_cast<std::size_t>(i)]);
    }
    return pressures;
  };
  OrganState state = rest_state(coarse.model);
  state.internal.pressures = linear(coarse);
  const OrganState refined = carried_linear(coarse, fine, state);
  CHECK((refined.internal.pressures - linear(fine)).norm() < 1e-14);
  CHECK(carried_linear(fine, coarse, refined).internal.pressures == state.internal.pressures);
}

TEST_CASE("mesh change: what holds an organ holds the same places on every mesh") {
  // Oracle: the coarse mesh's fixed nodes span what a refined mesh's may; a ball that lies between
  // coarse nodes holds nothing, however fine the mesh is there.
  scene::Organ organ = testing::solid_organ("nodal_pressure", 0.499);
  organ.fixed = {scene::BoxRegion{Vec3(-1, -1, -1), Vec3(1, 1, 1e-6)},
                 scene::SphereRegion{Vec3(0.0375, 0.0375, 0.06), 6e-3}};
  FollowingMesh mesh(cube_to_change(), 0.6, 20000);
  const SolidThere coarse(mesh, {}, organ);
  const SolidThere fine(mesh, {touch_at({0.0375, 0.0375, 0.06}), touch_at({0.03, 0.03, 0})}, organ);
  CHECK(coarse.model.fixed_nodes.size() == 25);
  CHECK(fine.model.fixed_nodes.size() > 50);
  for (const std::uint32_t node : fine.model.fixed_nodes) {
    CHECK(fine.model.rest_positions[node].z() == 0);
    CHECK(fine.model.inverse_masses[node] == 0);
  }
  for (std::uint32_t i = 0; i < fine.model.node_count(); ++i) {
    if (fine.model.rest_positions[i].z() > 0) CHECK(fine.model.inverse_masses[i] > 0);
  }
}

}  // namespace
}  // namespace palpate::deformation
