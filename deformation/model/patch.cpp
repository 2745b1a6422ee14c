#include "deformation/model/patch.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

namespace palpate::deformation {

Neighbours::Neighbours(const Body& body, std::span<const std::array<std::uint32_t, 4>> tetrahedra)
    : starts_(body.node_count() + 1, 0) {
  const auto for_each_edge = [&](const auto& join) {
    for (const auto& t : body.triangles) {
      for (std::size_t k = 0; k < 3; ++k) join(t[k], t[(k + 1) % 3]);
    }
    for (const auto& t : tetrahedra) {
      for (std::size_t a = 0; a < 4; ++a) {
        for (std::size_t b = a + 1; b < 4; ++b) join(t[a], t[b]);
      }
    }
  };
  // As often as edges say so, list by list; then each once.
  std::vector<std::uint32_t> ends(body.node_count() + 1, 0);
  for_each_edge([&](std::uint32_t a, std::uint32_t b) { ++ends[a + 1], ++ends[b + 1]; });
  std::partial_sum(ends.begin(), ends.end(), ends.begin());
  std::vector<std::uint32_t> all(ends.back()), firsts = ends;
  for_each_edge([&](std::uint32_t a, std::uint32_t b) {
    all[ends[a]++] = b;
    all[ends[b]++] = a;
  });
  std::vector<std::uint32_t> seen_by(body.node_count(), 0);
  for (std::uint32_t i = 0; i < body.node_count(); ++i) {
    const auto begin = static_cast<std::ptrdiff_t>(neighbours_.size());
    for (std::uint32_t k = firsts[i]; k < firsts[i + 1]; ++k) {
      if (std::exchange(seen_by[all[k]], i + 1) != i + 1) neighbours_.push_back(all[k]);
    }
    std::sort(neighbours_.begin() + begin, neighbours_.end());
    starts_[i + 1] = static_cast<std::uint32_t>(neighbours_.size());
  }
}

void grow_patch(const Body& body, const Neighbours& neighbours, const std::vector<Vec3>& positions,
                std::span<const std::uint32_t> touched, const Vec3& centre, std::size_t most,
                Patch& patch) {
  constexpr std::int32_t kElsewhere = -1, kInRing = -2;
  patch.places.resize(body.node_count(), kElsewhere);
  for (const std::uint32_t node : patch.nodes) patch.places[node] = kElsewhere;
  patch.nodes.clear();
  std::vector<std::uint32_t> ring(touched.begin(), touched.end());
  std::vector<std::pair<double, std::uint32_t>> by_distance;
  for (std::size_t first = 0; !ring.empty() && patch.nodes.size() < most;) {
    by_distance.clear();
    for (const std::uint32_t node : ring) {
      if (patch.places[node] != kElsewhere || body.inverse_masses[node] == 0) continue;
      patch.places[node] = kInRing;
      by_distance.push_back({(positions[node] - centre).squaredNorm(), node});
    }
    // A plate touches thousands: only those taken are put in order.
    const std::size_t taken = std::min(by_distance.size(), most - patch.nodes.size());
    std::partial_sort(by_distance.begin(), by_distance.begin() + static_cast<std::ptrdiff_t>(taken),
                      by_distance.end());
    for (std::size_t i = 0; i < by_distance.size(); ++i) {
      const std::uint32_t node = by_distance[i].second;
      patch.places[node] = i < taken ? static_cast<std::int32_t>(patch.nodes.size()) : kElsewhere;
      if (i < taken) patch.nodes.push_back(node);
    }
    ring.clear();
    for (; first < patch.nodes.size(); ++first) {
      const auto next = neighbours.of(patch.nodes[first]);
      ring.insert(ring.end(), next.begin(), next.end());
    }
  }
}

// Of equilateral triangles: a node's six springs k resist with 3 k, and a motion decays over √(k/m)
// edges; N nodes fill a circle of √(N/c) edges, c = 2π/√3.

double edges_in_reach(double stiffness) { return 2 * std::sqrt(stiffness / 3); }

std::size_t nodes_in_reach(std::size_t touched, double edges) {
  const double c = 2 * std::numbers::pi / std::sqrt(3.0);
  const double radius = std::sqrt(static_cast<double>(touched) / c) + edges;
  return static_cast<std::size_t>(std::ceil(c * radius * radius));
}

}  // namespace palpate::deformation
