#include "deformation/model/mesh_change.h"

#include <algorithm>

#include "modules/geometry/surface_transfer.h"

namespace palpate::deformation {
namespace {

using geometry::kNoPlace;
using Parents = MeshChange::Parents;

constexpr std::uint32_t kCoarse = geometry::HalvedMesh::kNone;

/// 0 of the coarse mesh, else one more than the higher parent's.
std::vector<int> levels_of(std::span<const Parents> parents) {
  constexpr int kUnknown = -1;
  std::vector<int> levels(parents.size(), kUnknown);
  std::vector<std::uint32_t> waiting;
  for (std::uint32_t i = 0; i < parents.size(); ++i) {
    waiting.assign(1, i);
    while (!waiting.empty()) {
      const std::uint32_t node = waiting.back();
      const auto& [a, b] = parents[node];
      if (a != kCoarse && levels[a] == kUnknown) {
        waiting.push_back(a);
      } else if (a != kCoarse && levels[b] == kUnknown) {
        waiting.push_back(b);
      } else {
        levels[node] = a == kCoarse ? 0 : 1 + std::max(levels[a], levels[b]);
        waiting.pop_back();
      }
    }
  }
  return levels;
}

}  // namespace

MeshChange::MeshChange(const Body& from, std::span<const Parents> from_parents, const Body& to,
                       std::span<const Parents> to_parents)
    : from_(from), to_(to), kept_(geometry::same_places(to.rest_positions, from.rest_positions)) {
  std::vector<bool> stays(from.node_count(), false);
  for (std::uint32_t i = 0; i < kept_.size(); ++i) {
    if (kept_[i] == kNoPlace) {
      coming_.push_back({i, to_parents[i]});
    } else {
      stays[kept_[i]] = true;
    }
  }
  for (std::uint32_t i = 0; i < stays.size(); ++i) {
    if (!stays[i]) going_.push_back({i, from_parents[i]});
  }
  const std::vector<int> to_levels = levels_of(to_parents), from_levels = levels_of(from_parents);
  std::ranges::stable_sort(coming_, {}, [&](const Middle& m) { return to_levels[m.node]; });
  std::ranges::stable_sort(going_, {}, [&](const Middle& m) { return -from_levels[m.node]; });
}

template <class Values>
void MeshChange::interpolate(const Values& from, Values& to) const {
  for (std::uint32_t i = 0; i < kept_.size(); ++i) {
    if (kept_[i] != kNoPlace) to[i] = from[kept_[i]];
  }
  for (const Middle& middle : coming_) {
    to[middle.node] = (to[middle.ends[0]] + to[middle.ends[1]]) / 2;
  }
}

OrganState MeshChange::carried(const OrganState& state) const {
  std::vector<double> masses = from_.masses;
  std::vector<Vec3> velocities(masses.size());  // momenta at first
  for (std::size_t i = 0; i < masses.size(); ++i) velocities[i] = masses[i] * state.velocities[i];
  for (const Middle& middle : going_) {
    for (const std::uint32_t end : middle.ends) {
      masses[end] += masses[middle.node] / 2;
      velocities[end] += velocities[middle.node] / 2;
    }
  }
  for (std::size_t i = 0; i < masses.size(); ++i) velocities[i] /= masses[i];
  OrganState carried = state;
  carried.internal = {};
  if (state.internal.pressures.size() > 0) {
    carried.internal.pressures.resize(static_cast<Eigen::Index>(kept_.size()));
    interpolate(state.internal.pressures, carried.internal.pressures);
  }
  carried.positions.assign(to_.node_count(), Vec3::Zero());
  carried.velocities.assign(to_.node_count(), Vec3::Zero());
  interpolate(state.positions, carried.positions);
  interpolate(velocities, carried.velocities);
  for (const std::uint32_t node : to_.fixed_nodes) carried.velocities[node].setZero();
  return carried;
}

std::vector<Vec4f> MeshChange::carried(const std::vector<Vec4f>& ways) const {
  std::vector<Vec4f> carried(to_.node_count(), Vec4f::Zero());
  interpolate(ways, carried);
  for (const std::uint32_t node : to_.fixed_nodes) carried[node].setZero();
  return carried;
}

void hold_as_coarse(const RefinedShape& refined, Body& body) {
  const std::vector<int> levels = levels_of(refined.parents);
  const bool middles_are_coarse = !refined.shape.edge_nodes.empty();
  std::vector<std::uint32_t> held = body.fixed_nodes;
  std::ranges::stable_sort(held, {}, [&](std::uint32_t node) { return levels[node]; });
  std::vector<char> rests(body.node_count(), 0);  // with all that it comes from
  for (const std::uint32_t node : held) {
    const auto& [a, b] = refined.parents[node];
    rests[node] = a == kCoarse || (rests[a] && rests[b]);
    if (rests[node] || (middles_are_coarse && levels[node] == 1)) continue;
    body.inverse_masses[node] = 1 / body.masses[node];
  }
  std::erase_if(body.fixed_nodes,
                [&](std::uint32_t node) { return body.inverse_masses[node] > 0; });
}

}  // namespace palpate::deformation
