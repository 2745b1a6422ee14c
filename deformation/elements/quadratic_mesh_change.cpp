#include "deformation/elements/quadratic_mesh_change.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "deformation/elements/quadrature.h"
#include "deformation/model/solid_masses.h"
#include "modules/core/error.h"
#include "modules/geometry/surface_transfer.h"

namespace palpate::deformation {
namespace {

using geometry::kNoPlace;
using Nodes = std::array<std::uint32_t, 10>;

Nodes nodes_of(const TetMesh& mesh, std::size_t e) {
  Nodes nodes{};
  const auto middles = std::ranges::copy(mesh.tetrahedra[e], nodes.begin()).out;
  std::ranges::copy(mesh.edge_nodes[e], middles);
  return nodes;
}

/// Of a node of halves: whole multiples of a power of two, so what rounding left is taken away.
Eigen::Vector4d barycentric(const Vec3& x, const std::vector<Vec3>& nodes, const Nodes& in) {
  constexpr double kGrid = 1 << 30;
  Mat3 edges;
  for (int k = 0; k < 3; ++k) {
    edges.col(k) = nodes[in[static_cast<std::size_t>(k) + 1]] - nodes[in[0]];
  }
  const Vec3 far = ((edges.inverse() * (x - nodes[in[0]])).array() * kGrid).round() / kGrid;
  return {1 - far.sum(), far.x(), far.y(), far.z()};
}

/// The end of the row of halves that makes up what was halved `halvings` times.
std::size_t end_of_row(std::span<const std::uint8_t> of_halves, std::size_t first, int halvings) {
  double volume = 0;
  while (volume < 1) volume += std::exp2(halvings - of_halves[first++]);
  return first;
}

}  // namespace

QuadraticMeshChange::QuadraticMeshChange(const OrganModel& from,
                                         std::span<const std::uint8_t> from_halvings,
                                         const OrganModel& to,
                                         std::span<const std::uint8_t> to_halvings)
    : from_(from), to_(to), kept_(geometry::same_places(to.rest_positions, from.rest_positions)) {
  PALPATE_DEMAND(from_halvings.size() == from.mesh().edge_nodes.size());
  PALPATE_DEMAND(to_halvings.size() == to.mesh().edge_nodes.size());
  find_parts(from_halvings, to_halvings);
}

void QuadraticMeshChange::find_parts(std::span<const std::uint8_t> from_halvings,
                                     std::span<const std::uint8_t> to_halvings) {
  const auto append = [](const OrganModel& model, std::size_t first, std::size_t end,
                         std::vector<Share>& shares) {
    for (std::size_t e = first; e < end; ++e) {
      const double mass = tetrahedron_mass(model.mesh(), e, model.rest_positions);
      const Nodes nodes = nodes_of(model.mesh(), e);
      for (std::size_t a = 0; a < nodes.size(); ++a) {
        shares.push_back(
            {nodes[a], (a < 4 ? kQuadraticCornerShare : kQuadraticMiddleShare) * mass});
      }
    }
  };
  std::vector<bool> found(to_.node_count(), false);
  for (std::size_t i = 0; i < kept_.size(); ++i) found[i] = kept_[i] != kNoPlace;
  for (std::size_t i = 0, j = 0; i < from_halvings.size();) {
    const int level = std::min(from_halvings[i], to_halvings[j]);
    const std::size_t from_end = end_of_row(from_halvings, i, level);
    const std::size_t to_end = end_of_row(to_halvings, j, level);
    if (from_halvings[i] != to_halvings[j]) {
      append(from_, i, from_end, parts_.emplace_back().before);
      append(to_, j, to_end, parts_.back().after);
      if (from_halvings[i] == level) find_coming(i, j, to_end, found);
    }
    rows_.push_back({i, from_end, j, to_end});
    i = from_end;
    j = to_end;
  }
  PALPATE_DEMAND(std::ranges::find(found, false) == found.end());
}

void QuadraticMeshChange::find_coming(std::size_t in, std::size_t first, std::size_t end,
                                      std::vector<bool>& found) {
  const Nodes whole = nodes_of(from_.mesh(), in);
  for (std::size_t e = first; e < end; ++e) {
    for (const std::uint32_t node : nodes_of(to_.mesh(), e)) {
      if (found[node]) continue;
      found[node] = true;
      Coming coming{node, whole, {}};
      const auto shape =
          quadratic_shape(barycentric(to_.rest_positions[node], from_.rest_positions, whole));
      std::ranges::copy(shape, coming.shape.begin());
      coming_.push_back(coming);
    }
  }
}

/// Adds to `velocities` what this part changes of those found.
void QuadraticMeshChange::hand_over(const Part& part, const std::vector<Vec3>& before,
                                    const std::vector<Vec3>& found,
                                    std::vector<Vec3>& velocities) const {
  const Vec3 first = before[part.before.front().node];  // an even motion has no difference from it
  double mass = 0;
  Vec3 momentum = Vec3::Zero(), found_momentum = Vec3::Zero();
  for (const auto& [node, share] : part.before) {
    mass += share;
    momentum += share * (before[node] - first);
  }
  for (const auto& [node, share] : part.after) found_momentum += share * (found[node] - first);
  const Vec3 mean = first + momentum / mass, found_mean = first + found_momentum / mass;
  double energy = 0, found_energy = 0;  // twice that of the difference from the mean
  for (const auto& [node, share] : part.before) {
    energy += share * (before[node] - mean).squaredNorm();
  }
  for (const auto& [node, share] : part.after) {
    found_energy += share * (found[node] - found_mean).squaredNorm();
  }
  const double part_kept = found_energy > energy ? std::sqrt(energy / found_energy) : 1;
  for (const auto& [node, share] : part.after) {
    const Vec3 given = mean + part_kept * (found[node] - found_mean);
    velocities[node] += share / to_.masses[node] * (given - found[node]);
  }
}

std::vector<Vec4f> QuadraticMeshChange::carried(const std::vector<Vec4f>& ways) const {
  std::vector<Vec4f> carried(to_.node_count(), Vec4f::Zero());
  for (std::size_t i = 0; i < kept_.size(); ++i) {
    if (kept_[i] != kNoPlace) carried[i] = ways[kept_[i]];
  }
  for (const Coming& coming : coming_) {
    for (std::size_t a = 0; a < coming.in.size(); ++a) {
      carried[coming.node] += static_cast<float>(coming.shape[a]) * ways[coming.in[a]];
    }
  }
  for (const std::uint32_t node : to_.fixed_nodes) carried[node].setZero();
  return carried;
}

Eigen::VectorXd QuadraticMeshChange::carried(const Eigen::VectorXd& pressures) const {
  Eigen::VectorXd carried(static_cast<Eigen::Index>(to_.mesh().tetrahedra.size()));
  for (const Row& row : rows_) {
    double mass = 0, sum = 0;
    for (std::size_t e = row.from; e < row.from_end; ++e) {
      const double own = tetrahedron_mass(from_.mesh(), e, from_.rest_positions);
      mass += own;
      sum += own * pressures[static_cast<Eigen::Index>(e)];
    }
    for (std::size_t e = row.to; e < row.to_end; ++e) {
      carried[static_cast<Eigen::Index>(e)] = sum / mass;
    }
  }
  return carried;
}

OrganState QuadraticMeshChange::carried(const OrganState& state) const {
  OrganState carried = state;
  carried.internal = {};
  carried.positions = to_.rest_positions;
  carried.velocities.assign(to_.node_count(), Vec3::Zero());
  for (std::size_t i = 0; i < kept_.size(); ++i) {
    if (kept_[i] == kNoPlace) continue;
    carried.positions[i] = state.positions[kept_[i]];
    carried.velocities[i] = state.velocities[kept_[i]];
  }
  for (const Coming& coming : coming_) {
    // A fixed one stays at rest whatever the function says: regions need not hold whole edges.
    if (to_.inverse_masses[coming.node] == 0) continue;
    for (std::size_t a = 0; a < coming.in.size(); ++a) {
      const std::uint32_t node = coming.in[a];
      carried.positions[coming.node] +=
          coming.shape[a] * (state.positions[node] - from_.rest_positions[node]);
      carried.velocities[coming.node] += coming.shape[a] * state.velocities[node];
    }
  }
  const std::vector<Vec3> found = carried.velocities;
  for (const Part& part : parts_) hand_over(part, state.velocities, found, carried.velocities);
  for (const std::uint32_t node : to_.fixed_nodes) carried.velocities[node].setZero();
  if (state.internal.pressures.size() > 0) {
    carried.internal.pressures = this->carried(state.internal.pressures);
  }
  return carried;
}

}  // namespace palpate::deformation
