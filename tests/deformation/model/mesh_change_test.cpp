#include "deformation/model/mesh_change.h"

#include <catch2/catch.hpp>
#include <memory>
#include <random>

#include "deformation/elements/average_nodal_pressure.h"
#include "deformation/model/following_mesh.h"
#include "tests/deformation/steppers/tetrahedral_solids.h"

namespace palpate::deformation {
namespace {

geometry::OrganShape cube_to_change() {
  return geometry::shape_of(geometry::testing::block(Vec3::Constant(0.06), 4, 4, 4));
}

TouchedPlace touch_at(const Vec3& centre) { return {centre, 8e-3, 5e-3}; }

/// A solid on the mesh for some places, and its state.
struct Refined {
  RefinedShape refined;
  OrganModel model;

  explicit Refined(FollowingMesh& mesh, const std::vector<TouchedPlace>& places,
                   const scene::Organ& organ)
      : refined(mesh.fine_at(places)),
        model(build_organ_model(organ, Vec3::Zero(), refined.shape)) {
    hold_as_coarse(refined.parents, model);
  }
};

Vec3 momentum_in(const OrganModel& model, const OrganState& state) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i < model.node_count(); ++i) {
    sum += model.masses[i] * state.velocities[i];
  }
  return sum;
}

TEST_CASE("mesh change: momentum stays, kinetic energy never grows, an even motion stays even") {
  // Oracle: sums over the nodes. Velocities at random are the worst that can be carried.
  const scene::Organ organ = testing::solid_organ("nodal_pressure", 0.499);
  FollowingMesh mesh(cube_to_change(), 0.6, 20000);
  std::mt19937 random(11);
  std::uniform_real_distribution<double> any(-1, 1), place(0, 0.06);
  auto from = std::make_unique<Refined>(mesh, std::vector<TouchedPlace>{}, organ);
  OrganState state = rest_state(from->model);
  for (int change = 0; change < 50; ++change) {
    std::vector<TouchedPlace> places;
    if (change % 5 != 4) places.push_back(touch_at({place(random), place(random), 0.06}));
    auto to = std::make_unique<Refined>(mesh, places, organ);
    const MeshChange carry(from->model, from->refined.parents, to->model, to->refined.parents);
    for (Vec3& v : state.velocities) v = Vec3(any(random), any(random), any(random));
    const OrganState after = carry.carried(state);
    REQUIRE(after.positions.size() == to->model.node_count());
    CHECK((momentum_in(to->model, after) - momentum_in(from->model, state)).norm() <
          1e-12 * momentum_in(from->model, state).norm() + 1e-15);
    CHECK(kinetic_energy(to->model, after.velocities) <=
          kinetic_energy(from->model, state.velocities) * (1 + 1e-12));
    const Vec3 even(0.1, -0.2, 0.3);
    std::ranges::fill(state.velocities, even);
    for (const Vec3& v : carry.carried(state).velocities) CHECK((v - even).norm() < 1e-15);
    state = after;
    from = std::move(to);
  }
  for (std::size_t i = 0; i < state.positions.size(); ++i) {  // at rest all along
    CHECK((state.positions[i] - from->model.rest_positions[i]).norm() < 1e-16);
  }
}

TEST_CASE("mesh change: a finer mesh is the same shape, and an even strain costs the same energy") {
  // Oracle: an affine map is exact on any mesh: its energy is the same, refined or not, and back.
  const scene::Organ organ = testing::solid_organ("nodal_pressure", 0.499);
  FollowingMesh mesh(cube_to_change(), 0.6, 20000);
  const Refined coarse(mesh, {}, organ), fine(mesh, {touch_at({0.02, 0.03, 0.06})}, organ);
  OrganState state = rest_state(coarse.model);
  Mat3 F;
  F << 1.05, 0.1, 0, -0.04, 0.98, 0.06, 0.02, 0, 0.99;
  for (Vec3& x : state.positions) x = F * x;
  const MeshChange finer(coarse.model, coarse.refined.parents, fine.model, fine.refined.parents);
  const MeshChange back(fine.model, fine.refined.parents, coarse.model, coarse.refined.parents);
  const auto energy = [&](const Refined& of, const OrganState& at) {
    return AverageNodalPressure(
               LinearTetrahedra(of.model.rest_positions, of.model.mesh().tetrahedra),
               of.model.mesh().elastic())
        .energy(at.positions);
  };
  const OrganState refined = finer.carried(state);
  for (std::size_t i = 0; i < refined.positions.size(); ++i) {
    CHECK((refined.positions[i] - F * fine.model.rest_positions[i]).norm() < 1e-15);
  }
  CHECK(energy(fine, refined) == Approx(energy(coarse, state)).epsilon(1e-9));
  CHECK(back.carried(refined).positions == state.positions);
}

TEST_CASE("mesh change: what holds an organ holds the same places on every mesh") {
  // Oracle: the coarse mesh's fixed nodes span what a refined mesh's may; a ball that lies between
  // coarse nodes holds nothing, however fine the mesh is there.
  scene::Organ organ = testing::solid_organ("nodal_pressure", 0.499);
  organ.fixed = {scene::BoxRegion{Vec3(-1, -1, -1), Vec3(1, 1, 1e-6)},
                 scene::SphereRegion{Vec3(0.0375, 0.0375, 0.06), 6e-3}};
  FollowingMesh mesh(cube_to_change(), 0.6, 20000);
  const Refined coarse(mesh, {}, organ);
  const Refined fine(mesh, {touch_at({0.0375, 0.0375, 0.06}), touch_at({0.03, 0.03, 0})}, organ);
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
