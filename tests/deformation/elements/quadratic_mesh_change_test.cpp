#include "deformation/elements/quadratic_mesh_change.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <random>

#include "deformation/elements/quadratic_pressure.h"
#include "modules/geometry/surface_transfer.h"
#include "tests/deformation/model/mesh_changes.h"
#include "tests/deformation/steppers/tetrahedral_solids.h"

namespace palpate::deformation {
namespace {

using testing::SolidThere;

geometry::OrganShape quadratic_cube() {
  return geometry::with_edge_nodes(
      geometry::shape_of(geometry::testing::block(Vec3::Constant(0.06), 3, 3, 3)));
}

TouchedPlace small_touch_at(const Vec3& centre) { return {centre, 6e-3, 8e-3}; }

OrganState carried_quadratic(const SolidThere& from, const SolidThere& to,
                             const OrganState& state) {
  return QuadraticMeshChange(from.model, from.refined.halvings, to.model, to.refined.halvings)
      .carried(state);
}

scene::Organ quadratic_organ() { return testing::solid_organ("quadratic_pressure", 0.499); }

/// Bends, twists and swells by some tenths over the cube.
Vec3 quadratic_map(const Vec3& X) {
  const Vec3 s = X / 0.06;
  return X + 6e-3 * Vec3(s.x() * s.y() - 0.5 * s.z() * s.z(), 0.8 * s.x() * s.x() + s.y() * s.z(),
                         s.x() * s.z() - 0.7 * s.y() * s.y() + 0.3 * s.z());
}

TEST_CASE("quadratic mesh change: momentum stays, kinetic energy never grows") {
  const scene::Organ organ = quadratic_organ();
  FollowingMesh mesh(quadratic_cube(), 1, 20000);
  OrganState state;
  std::mt19937 random(12);
  const auto last = testing::change_meshes(
      mesh, organ, 30, 11, small_touch_at, [&](const SolidThere& from, const SolidThere& to) {
        if (state.positions.empty()) state = rest_state(from.model);
        testing::check_motion_carried(from, to, random, state, [&](const OrganState& s) {
          return carried_quadratic(from, to, s);
        });
      });
  CHECK(state.positions == last->model.rest_positions);  // at rest all along, to the bit
}

TEST_CASE(
    "quadratic mesh change: what holds an organ holds middles of coarse edges, on every mesh") {
  // Oracle: the nodes of the mesh without a past that lie in the region, whatever is refined; of
  // edges of 20 mm that stand on the base those are the middles, 10 mm up. A node that comes
  // between a held middle and a free corner is free.
  scene::Organ organ = quadratic_organ();
  organ.fixed = {scene::BoxRegion{Vec3(-1, -1, -1), Vec3(1, 1, 12e-3)}};
  const auto shape = quadratic_cube();
  FollowingMesh mesh(shape, 1, 20000);
  const SolidThere fine(mesh, {small_touch_at({0.03, 0.03, 0.0})}, organ);
  const auto& rest = fine.model.rest_positions;
  const auto is_fixed = [&](const Vec3& x) {
    const auto found = std::ranges::find(rest, x);
    REQUIRE(found != rest.end());
    return fine.model.inverse_masses[static_cast<std::size_t>(found - rest.begin())] == 0;
  };
  std::size_t middles = 0;
  for (std::size_t i = 0; i < shape.node_count(); ++i) {
    const Vec3 x = shape.node(i);
    CHECK(is_fixed(x) == (x.z() < 12e-3));
    middles += x.z() > 1e-6 && x.z() < 12e-3;
  }
  CHECK(middles >= 16);
  std::size_t free_in_region = 0;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    if (rest[i].z() < 12e-3) free_in_region += fine.model.inverse_masses[i] > 0;
  }
  CHECK(free_in_region > 0);
  const SolidThere coarse(mesh, {}, organ);
  CHECK(coarse.model.fixed_nodes.size() < fine.model.fixed_nodes.size());
  const auto carried = carried_quadratic(coarse, fine, rest_state(coarse.model));
  CHECK(carried.positions == rest);
}

TEST_CASE("quadratic mesh change: a quadratic shape is carried from mesh to mesh as it is") {
  // Oracle: a quadratic function is one on every mesh, finer here and coarser there; kept nodes
  // keep their bits. What is lost is rounding, of lengths of 6 cm.
  const scene::Organ organ = quadratic_organ();
  FollowingMesh mesh(quadratic_cube(), 1, 20000);
  OrganState state;
  testing::change_meshes(mesh, organ, 20, 5, small_touch_at,
                         [&](const SolidThere& from, const SolidThere& to) {
                           if (state.positions.empty()) {
                             state = rest_state(from.model);
                             for (Vec3& x : state.positions) x = quadratic_map(x);
                           }
                           state = carried_quadratic(from, to, state);
                           double furthest = 0;
                           for (std::size_t i = 0; i < state.positions.size(); ++i) {
                             const Vec3 there = quadratic_map(to.model.rest_positions[i]);
                             furthest = std::max(furthest, (state.positions[i] - there).norm());
                           }
                           CHECK(furthest < 1e-15);
                         });
}

TEST_CASE("quadratic mesh change: how far nodes go is carried as where they are") {
  const scene::Organ organ = quadratic_organ();
  FollowingMesh mesh(quadratic_cube(), 1, 20000);
  const SolidThere coarse(mesh, {}, organ), fine(mesh, {small_touch_at({0.02, 0.03, 0.06})}, organ);
  OrganState state = rest_state(coarse.model);
  state.positions = testing::shaken(coarse.model, 5e-3);
  const QuadraticMeshChange change(coarse.model, coarse.refined.halvings, fine.model,
                                   fine.refined.halvings);
  testing::check_ways_carried(coarse.model, fine.model, change, state);
}

TEST_CASE(
    "quadratic mesh change: halves press as the whole, and the whole as its halves in the mean") {
  // Oracle: Σ V p over the body stays, whatever changes; what goes to finer meshes comes back.
  const scene::Organ organ = quadratic_organ();
  FollowingMesh mesh(quadratic_cube(), 1, 20000);
  const SolidThere coarse(mesh, {}, organ), one(mesh, {small_touch_at({0.01, 0.02, 0.06})}, organ),
      other(mesh, {small_touch_at({0.04, 0.03, 0.06})}, organ);
  const auto pushed = [](const SolidThere& there, const OrganState& state) {
    double sum = 0;
    for (std::size_t e = 0; e < there.model.mesh().tetrahedra.size(); ++e) {
      const auto& t = there.model.mesh().tetrahedra[e];
      const auto& x = there.model.rest_positions;
      sum += geometry::tetrahedron_volume(x[t[0]], x[t[1]], x[t[2]], x[t[3]]) *
             state.internal.pressures[static_cast<Eigen::Index>(e)];
    }
    return sum;
  };
  OrganState state = rest_state(coarse.model);
  CHECK(carried_quadratic(coarse, one, state).internal.pressures.size() == 0);
  state.internal.pressures =
      Eigen::VectorXd::Random(static_cast<Eigen::Index>(coarse.model.mesh().tetrahedra.size()));
  const double expected = pushed(coarse, state);
  const OrganState fine = carried_quadratic(coarse, one, state);
  const OrganState moved = carried_quadratic(one, other, fine);
  CHECK(pushed(one, fine) == Approx(expected).epsilon(1e-12));
  CHECK(pushed(other, moved) == Approx(expected).epsilon(1e-12));
  const OrganState back = carried_quadratic(other, coarse, moved);
  CHECK((back.internal.pressures - state.internal.pressures).norm() < 1e-12);
}

TEST_CASE("quadratic mesh change: any shape is the same function on a finer mesh, and back") {
  // Oracle: of nodes at random the way back gives the same bits; a cube blown up evenly has one
  // energy on any mesh.
  const scene::Organ organ = quadratic_organ();
  FollowingMesh mesh(quadratic_cube(), 1, 20000);
  const SolidThere coarse(mesh, {}, organ), fine(mesh, {small_touch_at({0.02, 0.03, 0.06})}, organ);
  REQUIRE(fine.model.node_count() > coarse.model.node_count() + 100);
  OrganState state = rest_state(coarse.model);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> any(-1e-3, 1e-3);
  for (Vec3& x : state.positions) x += Vec3(any(random), any(random), any(random));
  const OrganState refined = carried_quadratic(coarse, fine, state);
  CHECK(carried_quadratic(fine, coarse, refined).positions == state.positions);
  for (std::size_t i = 0; i < state.positions.size(); ++i) {
    state.positions[i] = 1.1 * coarse.model.rest_positions[i];
  }
  const auto energy = [](const SolidThere& of, const OrganState& at) {
    return QuadraticPressure(of.model.rest_positions, of.model.mesh()).energy(at.positions);
  };
  // Its metrics are floats.
  CHECK(energy(fine, carried_quadratic(coarse, fine, state)) ==
        Approx(energy(coarse, state)).epsilon(1e-5));
}

TEST_CASE("quadratic mesh change: a turning motion is carried to finer meshes as it is") {
  // Oracle: lumped masses hold linear functions' momentum on any mesh, and finer ones turn with
  // less energy, so there is nothing to take away.
  const scene::Organ organ = quadratic_organ();
  FollowingMesh mesh(quadratic_cube(), 1, 20000);
  const SolidThere coarse(mesh, {}, organ), fine(mesh, {small_touch_at({0.02, 0.03, 0.06})}, organ);
  const Vec3 turn(3, -1, 2), way(0.1, 0, 0.2);
  const auto velocity = [&](const Vec3& X) -> Vec3 { return turn.cross(X) + way; };
  OrganState state = rest_state(coarse.model);
  for (std::size_t i = 0; i < state.velocities.size(); ++i) {
    state.velocities[i] = velocity(coarse.model.rest_positions[i]);
  }
  const OrganState after = carried_quadratic(coarse, fine, state);
  for (std::size_t i = 0; i < after.velocities.size(); ++i) {
    CHECK((after.velocities[i] - velocity(fine.model.rest_positions[i])).norm() < 1e-14);
  }
}

TEST_CASE("quadratic mesh change: what holds an organ holds the same places on every mesh") {
  // Oracle: of the coarse mesh's faces at the bottom what lies on them, elsewhere its nodes alone:
  // of a ball about a middle of its edges that one, of a ball between its nodes nothing, however
  // fine the mesh is there. Held nodes stay at rest whatever moves beside them.
  scene::Organ organ = quadratic_organ();
  const Vec3 middle(0.03, 0.03, 0.06);
  organ.fixed = {scene::BoxRegion{Vec3(-1, -1, -1), Vec3(1, 1, 1e-6)},
                 scene::SphereRegion{middle, 6e-3},
                 scene::SphereRegion{Vec3(0.025, 0.025, 0.06), 5e-3}};
  FollowingMesh mesh(quadratic_cube(), 1, 20000);
  const SolidThere coarse(mesh, {}, organ);
  const SolidThere fine(mesh, {small_touch_at({0.03, 0.03, 0.06}), small_touch_at({0.02, 0.03, 0})},
                        organ);
  CHECK(coarse.model.fixed_nodes.size() == 49 + 1);
  CHECK(fine.model.fixed_nodes.size() > 80);
  for (std::uint32_t i = 0; i < fine.model.node_count(); ++i) {
    const Vec3& x = fine.model.rest_positions[i];
    const bool is_held = x.z() == 0 || (x - middle).norm() < 1e-12;
    CHECK((fine.model.inverse_masses[i] == 0) == is_held);
  }
  OrganState state = rest_state(coarse.model);
  for (std::size_t i = 0; i < state.positions.size(); ++i) {
    if (coarse.model.inverse_masses[i] > 0) state.positions[i] += Vec3(1e-3, 2e-3, -1e-3);
  }
  const OrganState after = carried_quadratic(coarse, fine, state);
  for (const std::uint32_t node : fine.model.fixed_nodes) {
    CHECK(after.positions[node] == fine.model.rest_positions[node]);
  }
}

TEST_CASE("surface transfer: a place on a quadratic solid's skin is the same place on another") {
  // Oracle: the rest place of every fourth of every face, before and after.
  const scene::Organ organ = quadratic_organ();
  FollowingMesh mesh(quadratic_cube(), 1, 20000);
  const SolidThere a(mesh, {small_touch_at({0.01, 0.02, 0.06})}, organ),
      b(mesh, {small_touch_at({0.03, 0.03, 0.06})}, organ);
  const auto skin = [](const OrganModel& model) {
    return std::span(model.rest_positions).first(model.surface_node_count);
  };
  const geometry::SurfaceTransfer transfer(skin(a.model), a.model.triangles, skin(b.model),
                                           b.model.triangles);
  const auto at = [](const OrganModel& model, std::uint32_t triangle, const Vec3& weights) {
    Vec3 x = Vec3::Zero();
    for (std::size_t k = 0; k < 3; ++k) {
      x += weights[static_cast<Eigen::Index>(k)] *
           model.rest_positions[model.triangles[triangle][k]];
    }
    return x;
  };
  int changed = 0;
  for (std::uint32_t t = 0; t < a.model.triangles.size(); ++t) {
    for (const Vec3& weights : {Vec3(0.2, 0.3, 0.5), Vec3(0.8, 0.15, 0.05), Vec3(0, 0.4, 0.6)}) {
      const auto found = transfer.place({t, weights});
      CHECK((at(a.model, t, weights) - at(b.model, found.triangle, found.weights)).norm() < 1e-15);
    }
    changed += transfer.triangle(t) == geometry::kNoPlace;
  }
  CHECK(changed > 50);
}

}  // namespace
}  // namespace palpate::deformation
