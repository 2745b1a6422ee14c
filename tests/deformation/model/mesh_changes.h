// Solids on the meshes of changing places, and what every change of mesh has to keep.
#pragma once

#include <algorithm>
#include <catch2/catch.hpp>
#include <functional>
#include <memory>
#include <random>
#include <vector>

#include "deformation/model/following_mesh.h"
#include "deformation/model/mesh_change.h"
#include "deformation/model/organ_model.h"

namespace palpate::deformation::testing {

/// A solid on the mesh for some places.
struct SolidThere {
  RefinedShape refined;
  OrganModel model;

  SolidThere(FollowingMesh& mesh, const std::vector<TouchedPlace>& places,
             const scene::Organ& organ)
      : refined(mesh.fine_at(places)),
        model(build_organ_model(organ, Vec3::Zero(), refined.shape)) {
    hold_as_coarse(refined, model);
  }

  Vec3 momentum(const OrganState& state) const {
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < model.node_count(); ++i) {
      sum += model.masses[i] * state.velocities[i];
    }
    return sum;
  }
};

/// A chain of changes from mesh to mesh on a cube of 6 cm, each fine at a place of its top at
/// random, every fifth at none.
/// @param around  what is touched about a place
/// @param changed  called with the solid before and after each change
/// @returns the last solid
inline std::unique_ptr<SolidThere> change_meshes(
    FollowingMesh& mesh, const scene::Organ& organ, int changes, unsigned seed,
    const std::function<TouchedPlace(const Vec3&)>& around,
    const std::function<void(const SolidThere&, const SolidThere&)>& changed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(0, 0.06);
  auto from = std::make_unique<SolidThere>(mesh, std::vector<TouchedPlace>{}, organ);
  for (int change = 0; change < changes; ++change) {
    std::vector<TouchedPlace> places;
    if (change % 5 != 4) places.push_back(around({place(random), place(random), 0.06}));
    auto to = std::make_unique<SolidThere>(mesh, places, organ);
    changed(*from, *to);
    from = std::move(to);
  }
  return from;
}

/// Oracle: sums over the nodes. Velocities at random are the worst that can be carried.
/// @param carried  a state from the first solid to the second
inline void check_motion_carried(const SolidThere& from, const SolidThere& to, std::mt19937& random,
                                 OrganState& state,
                                 const std::function<OrganState(const OrganState&)>& carried) {
  std::uniform_real_distribution<double> any(-1, 1);
  for (Vec3& v : state.velocities) v = Vec3(any(random), any(random), any(random));
  const OrganState after = carried(state);
  REQUIRE(after.positions.size() == to.model.node_count());
  // Sums of some thousand rounded numbers.
  CHECK((to.momentum(after) - from.momentum(state)).norm() <
        1e-12 * from.momentum(state).norm() + 1e-15);
  CHECK(kinetic_energy(to.model, after.velocities) <=
        kinetic_energy(from.model, state.velocities) * (1 + 1e-12));
  const Vec3 even(0.1, -0.2, 0.3);
  std::ranges::fill(state.velocities, even);
  for (const Vec3& v : carried(state).velocities) CHECK((v - even).norm() < 1e-15);
  state = after;
}

/// Oracle: positions carried, less those at rest; in float.
template <class Change>
void check_ways_carried(const OrganModel& from, const OrganModel& to, const Change& change,
                        const OrganState& state) {
  std::vector<Vec4f> ways;
  for (std::size_t i = 0; i < from.node_count(); ++i) {
    ways.push_back(wide(state.positions[i] - from.rest_positions[i]));
  }
  const std::vector<Vec4f> carried = change.carried(ways);
  const OrganState expected = change.carried(state);
  REQUIRE(carried.size() == to.node_count());
  double most = 0, off = 0;
  for (std::size_t i = 0; i < carried.size(); ++i) {
    const Vec3 way = expected.positions[i] - to.rest_positions[i];
    most = std::max(most, way.norm());
    off = std::max(off, (carried[i].template head<3>().template cast<double>() - way).norm());
  }
  CHECK(most > 0);
  CHECK(off < 1e-6 * most);
}

}  // namespace palpate::deformation::testing
