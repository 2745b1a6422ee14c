#include "deformation/springs/kernel/spring_kernel_layout.h"

#include <algorithm>
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

Alike common_values(const SpringNetwork& network, std::size_t first, std::size_t count) {
  if (count == 0) return {};
  const double stiffness = network.springs[first].stiffness;
  const double damping = network.damping[first];
  for (std::size_t s = first; s < first + count; ++s) {
    PALPATE_DEMAND(network.springs[s].stiffness == stiffness);
    PALPATE_DEMAND(network.damping[s] == damping);
  }
  return {stiffness, damping / stiffness};
}

std::uint32_t packed_offset(std::size_t node) {
  return static_cast<std::uint32_t>(kernel::kNodeFloats * node);
}

}  // namespace

SpringKernelLayout::Rows SpringKernelLayout::rows_of(const Body& body, const SpringNetwork& network,
                                                     std::size_t first, std::size_t count) {
  Rows rows(body.surface_node_count);
  for (std::size_t s = first; s < first + count; ++s) {
    const Spring& spring = network.springs[s];
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

SpringKernelLayout::SpringKernelLayout(const Body& body, const SpringNetwork& network,
                                       bool with_volume) {
  const std::size_t node_count = body.surface_node_count;
  scalars_.surface_node_count = node_count;
  scalars_.virtual_node_count = body.node_count() - node_count;
  scalars_.slice_count = (node_count + kernel::kLanes - 1) / kernel::kLanes;
  scalars_.slices_per_chunk =
      std::max(kLeastSlicesPerChunk, (scalars_.slice_count + kMostChunks - 1) / kMostChunks);
  scalars_.chunk_count =
      (scalars_.slice_count + scalars_.slices_per_chunk - 1) / scalars_.slices_per_chunk;

  const Alike structural = common_values(network, 0, network.structural_count);
  const Alike bending = common_values(network, network.structural_count, network.bending_count);
  scalars_.structural_stiffness = static_cast<float>(structural.stiffness);
  scalars_.structural_damping_time = static_cast<float>(structural.damping_time);
  scalars_.bending_stiffness = static_cast<float>(bending.stiffness);
  scalars_.bending_damping_time = static_cast<float>(bending.damping_time);

  add_rows(body);
  Rows first = rows_of(body, network, 0, network.structural_count);
  if (with_volume) {
    const auto rings = geometry::ordered_one_rings(body.triangles, node_count);
    put_in_order(rings, first);
    add_rings(rings);
    add_cover(rings);
  }
  const Rows second = rows_of(body, network, network.structural_count, network.bending_count);
  for (std::size_t slice = 0; slice < scalars_.slice_count; ++slice) {
    add_slice(slice * kernel::kLanes, first, second);
  }
  if (scalars_.virtual_node_count > 0) add_inner_springs(network);
}

void SpringKernelLayout::add_rows(const Body& body) {
  const std::size_t node_count = scalars_.surface_node_count;
  for (std::size_t row = 0; row < scalars_.slice_count * kernel::kLanes; ++row) {
    row_nodes_.push_back(packed_offset(std::min(row, node_count - 1)));
    inverse_masses_.insert(inverse_masses_.end(), 3,
                           row < node_count ? body.inverse_masses[row] : 0);
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

void SpringKernelLayout::FanArrays::add(std::span<const geometry::Fan> some) {
  std::size_t longest = 0;
  for (const geometry::Fan& fan : some) longest = std::max(longest, fan.nodes.size());
  // Triangles are taken in pairs.
  const std::size_t slots = 1 + longest + (longest + 1) % 2;
  fans.push_back({static_cast<std::uint32_t>(nodes.size() / kernel::kDoubleLanes),
                  static_cast<std::uint32_t>(slots)});
  for (std::size_t slot = 0; slot < slots; ++slot) {
    for (std::size_t lane = 0; lane < kernel::kDoubleLanes; ++lane) {
      std::uint32_t node = 0;  // lanes without a fan: a node and itself
      if (lane < some.size()) {
        const geometry::Fan& fan = some[lane];
        node = slot == 0 ? fan.center : fan.nodes[std::min(slot, fan.nodes.size()) - 1];
      }
      nodes.push_back(3 * node);
    }
  }
}

void SpringKernelLayout::add_rings(const std::vector<std::vector<std::uint32_t>>& rings) {
  std::vector<geometry::Fan> fans;
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
  auto fans = geometry::fans_of(rings);
  const std::size_t rows_per_chunk = kernel::kLanes * scalars_.slices_per_chunk;
  const auto chunk_of = [&](const geometry::Fan& fan) { return fan.center / rows_per_chunk; };
  // Fans of a length side by side need no padding.
  std::sort(fans.begin(), fans.end(), [&](const geometry::Fan& a, const geometry::Fan& b) {
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

void SpringKernelLayout::add_inner_springs(const SpringNetwork& network) {
  const std::size_t rows = row_nodes_.size();
  inner_nodes_.assign(rows, packed_offset(scalars_.surface_node_count));
  inner_rest_lengths_.assign(rows, 0);
  inner_stiffnesses_.assign(rows, 0);
  inner_dampings_.assign(rows, 0);
  for (std::size_t s = network.springs.size() - network.inner_count; s < network.springs.size();
       ++s) {
    const Spring& spring = network.springs[s];
    const std::size_t row = spring.node_a;
    PALPATE_DEMAND(row < scalars_.surface_node_count &&
                   spring.node_b >= scalars_.surface_node_count);
    PALPATE_DEMAND(inner_stiffnesses_[row] == 0);  // one per node
    inner_nodes_[row] = packed_offset(spring.node_b);
    inner_rest_lengths_[row] = static_cast<float>(spring.rest_length);
    inner_stiffnesses_[row] = static_cast<float>(spring.stiffness);
    inner_dampings_[row] = static_cast<float>(network.damping[s]);
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
