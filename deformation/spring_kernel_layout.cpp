#include "deformation/spring_kernel_layout.h"

#include <algorithm>
#include <set>
#include <tuple>
#include <utility>

#include "modules/core/error.h"

namespace palpate::deformation {
namespace {

/// Rows of a chunk: enough that starting one costs nothing, few enough that two threads share a
/// small organ evenly. At most kMostChunks, so that sums over them stay short.
constexpr std::size_t kLeastSlicesPerChunk = 8;
constexpr std::size_t kMostChunks = 64;

/// Stiffness and damping that all springs from `first` on have in common.
struct Alike {
  double stiffness = 0, damping_time = 0;
};

Alike common_values(const OrganModel& model, std::size_t first, std::size_t count) {
  if (count == 0) return {};
  const double stiffness = model.network.springs[first].stiffness;
  const double damping = model.spring_damping[first];
  for (std::size_t s = first; s < first + count; ++s) {
    PALPATE_DEMAND(model.network.springs[s].stiffness == stiffness);
    PALPATE_DEMAND(model.spring_damping[s] == damping);
  }
  return {stiffness, damping / stiffness};
}

std::uint32_t packed_offset(std::size_t node) {
  return static_cast<std::uint32_t>(kernel::kNodeFloats * node);
}

}  // namespace

std::vector<std::vector<std::uint32_t>> ordered_one_rings(
    const std::vector<geometry::Triangle>& triangles, std::size_t node_count) {
  using Edge = std::pair<std::uint32_t, std::uint32_t>;  // opposite a node: from, to
  std::vector<std::vector<Edge>> fans(node_count);
  for (const auto& [i, j, k] : triangles) {
    fans[i].emplace_back(j, k);
    fans[j].emplace_back(k, i);
    fans[k].emplace_back(i, j);
  }
  std::vector<std::vector<std::uint32_t>> rings(node_count);
  for (std::size_t node = 0; node < node_count; ++node) {
    auto& fan = fans[node];
    PALPATE_DEMAND(!fan.empty());
    std::sort(fan.begin(), fan.end());
    std::uint32_t next = fan.front().first;
    do {
      rings[node].push_back(next);
      const auto edge = std::lower_bound(fan.begin(), fan.end(), Edge{next, 0});
      PALPATE_DEMAND(edge != fan.end() && edge->first == next);
      next = edge->second;
    } while (next != rings[node].front() && rings[node].size() <= fan.size());
    PALPATE_DEMAND(rings[node].size() == fan.size());
  }
  return rings;
}

std::vector<Fan> fans_of(const std::vector<std::vector<std::uint32_t>>& rings) {
  // Of each node, whether the triangle from its k-th neighbour to the next is still in no fan.
  std::vector<std::vector<char>> left;
  std::set<std::pair<std::ptrdiff_t, std::uint32_t>> order;  // −triangles left, node
  for (std::uint32_t node = 0; node < rings.size(); ++node) {
    left.emplace_back(rings[node].size(), 1);
    order.emplace(-static_cast<std::ptrdiff_t>(rings[node].size()), node);
  }
  const auto take = [&](std::uint32_t node, std::uint32_t from) {
    const auto count = std::count(left[node].begin(), left[node].end(), 1);
    order.erase({-count, node});
    const auto& ring = rings[node];
    left[node][static_cast<std::size_t>(std::find(ring.begin(), ring.end(), from) - ring.begin())] =
        0;
    if (count > 1) order.emplace(1 - count, node);
  };
  std::vector<Fan> fans;
  while (!order.empty()) {
    const std::uint32_t center = order.begin()->second;
    const auto& ring = rings[center];
    // From a triangle that is taken on, or from anywhere if none is.
    const auto start = static_cast<std::size_t>(
        std::find(left[center].begin(), left[center].end(), 0) - left[center].begin());
    bool open = false;
    for (std::size_t step = 0; step < ring.size(); ++step) {
      const std::size_t k = (start + step) % ring.size();
      const std::uint32_t from = ring[k], to = ring[(k + 1) % ring.size()];
      const bool here = left[center][k] != 0;
      if (here && !open) fans.push_back({center, {from}});
      open = here;
      if (!here) continue;
      fans.back().nodes.push_back(to);
      take(center, from);
      take(from, to);
      take(to, center);
    }
  }
  return fans;
}

SpringKernelLayout::Rows SpringKernelLayout::rows_of(const OrganModel& model, std::size_t first,
                                                     std::size_t count) {
  Rows rows(model.surface_node_count());
  for (std::size_t s = first; s < first + count; ++s) {
    const Spring& spring = model.network.springs[s];
    rows[spring.node_a].push_back({spring.node_b, spring.rest_length});
    rows[spring.node_b].push_back({spring.node_a, spring.rest_length});
  }
  return rows;
}

void SpringKernelLayout::put_in_order(const std::vector<std::vector<std::uint32_t>>& rings,
                                      Rows& rows) {
  for (std::size_t node = 0; node < rows.size(); ++node) {
    auto& row = rows[node];
    PALPATE_DEMAND(row.size() == rings[node].size());
    for (std::size_t k = 0; k < row.size(); ++k) {
      const auto found = std::find_if(row.begin() + static_cast<std::ptrdiff_t>(k), row.end(),
                                      [&](const Neighbour& n) { return n.node == rings[node][k]; });
      PALPATE_DEMAND(found != row.end());
      std::swap(row[k], *found);
    }
  }
}

SpringKernelLayout::SpringKernelLayout(const OrganModel& model) {
  const std::size_t node_count = model.surface_node_count();
  scalars_.surface_node_count = node_count;
  scalars_.virtual_node_count = model.node_count() - node_count;
  scalars_.slice_count = (node_count + kernel::kLanes - 1) / kernel::kLanes;
  scalars_.slices_per_chunk =
      std::max(kLeastSlicesPerChunk, (scalars_.slice_count + kMostChunks - 1) / kMostChunks);
  scalars_.chunk_count =
      (scalars_.slice_count + scalars_.slices_per_chunk - 1) / scalars_.slices_per_chunk;

  const auto& network = model.network;
  const Alike structural = common_values(model, 0, network.structural_count);
  const Alike bending = common_values(model, network.structural_count, network.bending_count);
  scalars_.structural_stiffness = static_cast<float>(structural.stiffness);
  scalars_.structural_damping_time = static_cast<float>(structural.damping_time);
  scalars_.bending_stiffness = static_cast<float>(bending.stiffness);
  scalars_.bending_damping_time = static_cast<float>(bending.damping_time);

  add_rows(model);
  Rows first = rows_of(model, 0, network.structural_count);
  if (model.preserve_volume) {
    const auto rings = ordered_one_rings(model.triangles, node_count);
    put_in_order(rings, first);
    add_rings(rings);
    add_cover(rings);
  }
  const Rows second = rows_of(model, network.structural_count, network.bending_count);
  for (std::size_t slice = 0; slice < scalars_.slice_count; ++slice) {
    add_slice(slice * kernel::kLanes, first, second);
  }
  if (scalars_.virtual_node_count > 0) add_inner_springs(model);
}

void SpringKernelLayout::add_rows(const OrganModel& model) {
  const std::size_t node_count = scalars_.surface_node_count;
  for (std::size_t row = 0; row < scalars_.slice_count * kernel::kLanes; ++row) {
    row_nodes_.push_back(packed_offset(std::min(row, node_count - 1)));
    inverse_masses_.insert(inverse_masses_.end(), 3,
                           row < node_count ? model.inverse_masses[row] : 0);
  }
}

void SpringKernelLayout::add_slice(std::size_t first_row, const Rows& structural,
                                   const Rows& bending) {
  kernel::Slice slice;
  slice.first_slot = neighbours_.size() / kernel::kLanes;
  const std::size_t end = std::min(first_row + kernel::kLanes, scalars_.surface_node_count);
  std::size_t first = 0, second = 0, shortest = structural[first_row].size();
  for (std::size_t row = first_row; row < end; ++row) {
    first = std::max(first, structural[row].size());
    shortest = std::min(shortest, structural[row].size());
    second = std::max(second, bending[row].size());
  }
  slice.structural_slots = static_cast<std::uint32_t>(first);
  slice.slots = static_cast<std::uint32_t>(first + second);
  slice.shortest_ring = static_cast<std::uint32_t>(shortest);
  slices_.push_back(slice);
  for (std::size_t slot = 0; slot < first + second; ++slot) {
    const Rows& rows = slot < first ? structural : bending;
    const std::size_t k = slot < first ? slot : slot - first;
    for (std::size_t row = first_row; row < first_row + kernel::kLanes; ++row) {
      const bool present = row < end && k < rows[row].size();
      neighbours_.push_back(present ? packed_offset(rows[row][k].node) : row_nodes_[row]);
      rest_lengths_.push_back(present ? static_cast<float>(rows[row][k].rest_length)
                                      : kernel::kPaddingLength);
    }
  }
}

void SpringKernelLayout::FanArrays::add(std::span<const Fan> some) {
  std::size_t longest = 0;
  for (const Fan& fan : some) longest = std::max(longest, fan.nodes.size());
  // Triangles are taken in pairs.
  const std::size_t slots = 1 + longest + (longest + 1) % 2;
  fans.push_back({static_cast<std::uint32_t>(nodes.size() / kernel::kDoubleLanes),
                  static_cast<std::uint32_t>(slots)});
  for (std::size_t slot = 0; slot < slots; ++slot) {
    for (std::size_t lane = 0; lane < kernel::kDoubleLanes; ++lane) {
      std::uint32_t node = 0;  // lanes without a fan: a node and itself
      if (lane < some.size()) {
        const Fan& fan = some[lane];
        node = slot == 0 ? fan.center : fan.nodes[std::min(slot, fan.nodes.size()) - 1];
      }
      nodes.push_back(3 * node);
    }
  }
}

void SpringKernelLayout::add_rings(const std::vector<std::vector<std::uint32_t>>& rings) {
  std::vector<Fan> fans;
  for (const auto& ring : rings) {
    fans.push_back({static_cast<std::uint32_t>(fans.size()), ring});
    fans.back().nodes.push_back(ring.front());
  }
  // The last slice of rows may be half empty.
  fans.resize(scalars_.slice_count * kernel::kLanes, fans.back());
  for (std::size_t row = 0; row < fans.size(); row += kernel::kDoubleLanes) {
    rings_.add(std::span(fans).subspan(row, kernel::kDoubleLanes));
  }
}

void SpringKernelLayout::add_cover(const std::vector<std::vector<std::uint32_t>>& rings) {
  auto fans = fans_of(rings);
  const std::size_t rows_per_chunk = kernel::kLanes * scalars_.slices_per_chunk;
  const auto chunk_of = [&](const Fan& fan) { return fan.center / rows_per_chunk; };
  // Fans of a length side by side need no padding.
  std::sort(fans.begin(), fans.end(), [&](const Fan& a, const Fan& b) {
    return std::tuple(chunk_of(a), b.nodes.size(), a.center, a.nodes.front()) <
           std::tuple(chunk_of(b), a.nodes.size(), b.center, b.nodes.front());
  });
  std::size_t next = 0;
  for (std::size_t chunk = 0; chunk < scalars_.chunk_count; ++chunk) {
    first_fans_.push_back(static_cast<std::uint32_t>(cover_.fans.size()));
    while (next < fans.size() && chunk_of(fans[next]) == chunk) {
      std::size_t end = next;
      while (end < fans.size() && end < next + kernel::kDoubleLanes &&
             chunk_of(fans[end]) == chunk) {
        ++end;
      }
      cover_.add(std::span(fans).subspan(next, end - next));
      next = end;
    }
  }
  first_fans_.push_back(static_cast<std::uint32_t>(cover_.fans.size()));
}

void SpringKernelLayout::add_inner_springs(const OrganModel& model) {
  const std::size_t rows = row_nodes_.size();
  inner_nodes_.assign(rows, packed_offset(scalars_.surface_node_count));
  inner_rest_lengths_.assign(rows, 0);
  inner_stiffnesses_.assign(rows, 0);
  inner_dampings_.assign(rows, 0);
  const auto& network = model.network;
  for (std::size_t s = network.springs.size() - network.inner_count; s < network.springs.size();
       ++s) {
    const Spring& spring = network.springs[s];
    const std::size_t row = spring.node_a;
    PALPATE_DEMAND(row < network.surface_node_count && spring.node_b >= network.surface_node_count);
    PALPATE_DEMAND(inner_stiffnesses_[row] == 0);  // one per node
    inner_nodes_[row] = packed_offset(spring.node_b);
    inner_rest_lengths_[row] = static_cast<float>(spring.rest_length);
    inner_stiffnesses_[row] = static_cast<float>(spring.stiffness);
    inner_dampings_[row] = static_cast<float>(model.spring_damping[s]);
  }
  for (std::size_t slice = 0; slice < slices_.size(); ++slice) add_links(slice);
}

void SpringKernelLayout::add_links(std::size_t slice) {
  const std::size_t first = links_.size();
  for (std::size_t lane = 0; lane < kernel::kLanes; ++lane) {
    const auto node = static_cast<std::uint32_t>(inner_nodes_[slice * kernel::kLanes + lane] /
                                                     kernel::kNodeFloats -
                                                 scalars_.surface_node_count);
    auto link = std::find_if(links_.begin() + static_cast<std::ptrdiff_t>(first), links_.end(),
                             [node](const kernel::Link& l) { return l.virtual_node == node; });
    if (link == links_.end()) link = links_.insert(link, kernel::Link{node});
    link->weights[lane] = 1;
  }
  slices_[slice].first_link = static_cast<std::uint32_t>(first);
  slices_[slice].link_count = static_cast<std::uint32_t>(links_.size() - first);
}

kernel::Layout SpringKernelLayout::view() const {
  kernel::Layout layout = scalars_;
  layout.slices = slices_.data();
  layout.neighbours = neighbours_.data();
  layout.rest_lengths = rest_lengths_.data();
  layout.row_nodes = row_nodes_.data();
  layout.rings = rings_.view();
  layout.cover = cover_.view();
  layout.first_fans = first_fans_.data();
  layout.inverse_masses = inverse_masses_.data();
  layout.inner_nodes = inner_nodes_.data();
  layout.links = links_.data();
  layout.inner_rest_lengths = inner_rest_lengths_.data();
  layout.inner_stiffnesses = inner_stiffnesses_.data();
  layout.inner_dampings = inner_dampings_.data();
  return layout;
}

}  // namespace palpate::deformation
