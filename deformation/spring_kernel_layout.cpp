#include "deformation/spring_kernel_layout.h"

#include <algorithm>

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
  const Rows first = rows_of(model, 0, network.structural_count);
  const Rows second = rows_of(model, network.structural_count, network.bending_count);
  for (std::size_t slice = 0; slice < scalars_.slice_count; ++slice) {
    add_slice(slice * kernel::kLanes, first, second);
  }
  add_rings(ordered_one_rings(model.triangles, node_count));
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
  std::size_t first = 0, second = 0;
  for (std::size_t row = first_row; row < end; ++row) {
    first = std::max(first, structural[row].size());
    second = std::max(second, bending[row].size());
  }
  slice.structural_slots = static_cast<std::uint32_t>(first);
  slice.slots = static_cast<std::uint32_t>(first + second);
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

void SpringKernelLayout::add_rings(const std::vector<std::vector<std::uint32_t>>& rings) {
  const auto slices = scalars_.slice_count * (kernel::kLanes / kernel::kRingLanes);
  for (std::size_t slice = 0; slice < slices; ++slice) {
    const auto of_row = [&](std::size_t lane) {
      return std::min(slice * kernel::kRingLanes + lane, rings.size() - 1);
    };
    std::size_t longest = 0;
    for (std::size_t lane = 0; lane < kernel::kRingLanes; ++lane) {
      longest = std::max(longest, rings[of_row(lane)].size());
    }
    ring_slices_.push_back({static_cast<std::uint32_t>(ring_nodes_.size() / kernel::kRingLanes),
                            static_cast<std::uint32_t>(1 + longest)});
    for (std::size_t slot = 0; slot <= longest; ++slot) {
      for (std::size_t lane = 0; lane < kernel::kRingLanes; ++lane) {
        const auto& ring = rings[of_row(lane)];
        const std::size_t node =
            slot == 0 ? of_row(lane) : ring[slot <= ring.size() ? slot - 1 : 0];
        ring_nodes_.push_back(static_cast<std::uint32_t>(3 * node));
      }
    }
  }
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
  layout.ring_slices = ring_slices_.data();
  layout.ring_nodes = ring_nodes_.data();
  layout.inverse_masses = inverse_masses_.data();
  layout.inner_nodes = inner_nodes_.data();
  layout.links = links_.data();
  layout.inner_rest_lengths = inner_rest_lengths_.data();
  layout.inner_stiffnesses = inner_stiffnesses_.data();
  layout.inner_dampings = inner_dampings_.data();
  return layout;
}

}  // namespace palpate::deformation
