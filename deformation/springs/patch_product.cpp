#include "deformation/springs/patch_product.h"

#include <algorithm>
#include <numeric>

namespace palpate::deformation {

using kernel::kLanes;
using kernel::kNodeFloats;

std::uint32_t PatchProduct::place_of(const Patch& patch, std::uint32_t node) {
  const int place = patch.place(node);
  if (place >= 0) return static_cast<std::uint32_t>(place);
  std::int32_t& held = held_places_[node];
  if (held < 0) {
    held = static_cast<std::int32_t>(nodes_.size());
    held_.push_back(node);
    nodes_.push_back({springs_.nodes()[node].position, Vec4f::Zero()});
  }
  return static_cast<std::uint32_t>(held);
}

void PatchProduct::take(const Patch& patch) {
  count_ = patch.nodes.size();
  nodes_.assign(count_ + 1, WideNode{});
  for (std::size_t i = 0; i < count_; ++i) {
    nodes_[i].position = springs_.nodes()[patch.nodes[i]].position;
  }
  held_places_.resize(springs_.nodes().size(), -1);
  const std::size_t rows = (count_ + kLanes - 1) / kLanes * kLanes;
  row_nodes_.resize(rows);
  masses_.assign(rows, 0);
  const SpringMatrix whole = springs_.matrix();
  for (std::size_t row = 0; row < rows; ++row) {
    row_nodes_[row] = static_cast<std::uint32_t>(kNodeFloats * std::min(row, count_ - 1));
    if (row < count_) masses_[row] = whole.masses[patch.nodes[row]];
  }
  slices_.clear();
  neighbours_.clear();
  pairs_.clear();
  for (std::size_t first = 0; first < rows; first += kLanes) take_slice(patch, first);
  take_inner_springs(patch);
  for (const std::uint32_t node : held_) held_places_[node] = -1;
  held_.clear();
  all_slices_.resize(slices_.size());
  std::iota(all_slices_.begin(), all_slices_.end(), 0u);
  virtual_sums_.resize(parts() * 3 * kLanes * whole.layout.virtual_node_count);
  dots_.resize(parts() * kLanes);
  layout_.surface_node_count = count_;
  layout_.virtual_node_count = whole.layout.virtual_node_count;
  layout_.slice_count = slices_.size();
  layout_.slices = slices_.data();
  layout_.neighbours = neighbours_.data();
  layout_.row_nodes = row_nodes_.data();
  layout_.inner_nodes = inner_nodes_.data();
  contacts_.clear();
}

void PatchProduct::take_slice(const Patch& patch, std::size_t first_row) {
  const SpringMatrix whole = springs_.matrix();
  const auto slice_of = [&](std::size_t row) -> const kernel::Slice& {
    return whole.layout.slices[patch.nodes[row] / kLanes];
  };
  const std::size_t end = std::min(first_row + kLanes, count_);
  kernel::Slice slice;
  slice.first_slot = neighbours_.size() / kLanes;
  for (std::size_t row = first_row; row < end; ++row) {
    slice.slots = std::max(slice.slots, slice_of(row).slots);
  }
  slices_.push_back(slice);
  const std::size_t begin = neighbours_.size();
  pairs_.resize(begin + slice.slots * kLanes, 0);
  neighbours_.resize(begin + slice.slots * kLanes);
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    const std::size_t row = first_row + lane;
    const std::size_t slots = row < end ? slice_of(row).slots : 0;
    std::size_t to = begin + lane;
    for (std::size_t slot = 0; slot < slots; ++slot, to += kLanes) {
      const std::size_t from =
          (slice_of(row).first_slot + slot) * kLanes + patch.nodes[row] % kLanes;
      const std::uint32_t node = whole.layout.neighbours[from] / kNodeFloats;
      neighbours_[to] = static_cast<std::uint32_t>(kNodeFloats) * place_of(patch, node);
      pairs_[to] = whole.springs.pairs[from];
    }
    for (std::size_t slot = slots; slot < slice.slots; ++slot, to += kLanes) {
      neighbours_[to] = row_nodes_[row];
    }
  }
}

void PatchProduct::take_inner_springs(const Patch& patch) {
  const SpringMatrix whole = springs_.matrix();
  if (whole.layout.virtual_node_count == 0) return;
  inner_nodes_ = row_nodes_;
  inner_along_.assign(row_nodes_.size(), 0);
  inner_across_.assign(row_nodes_.size(), 0);
  for (std::size_t row = 0; row < count_; ++row) {
    const std::uint32_t node = patch.nodes[row];
    inner_nodes_[row] = static_cast<std::uint32_t>(kNodeFloats) *
                        place_of(patch, whole.layout.inner_nodes[node] / kNodeFloats);
    inner_along_[row] = whole.springs.inner_along[node];
    inner_across_[row] = whole.springs.inner_across[node];
  }
}

void PatchProduct::take_couplings(const Patch& patch) {
  contacts_.clear();
  for (ContactCoupling contact : springs_.matrix().contacts) {
    bool any = false;
    for (std::size_t k = 0; k < 3; ++k) {
      const int place = patch.place(contact.nodes[k]);
      if (place < 0) contact.arms[k].setZero();
      contact.nodes[k] = static_cast<std::uint32_t>(std::max(place, 0));
      any |= place >= 0;
    }
    if (any) contacts_.push_back(contact);
  }
}

double PatchProduct::apply(std::vector<Vec4f>& out) {
  const SpringMatrix whole = springs_.matrix();
  kernel::Couplings in;
  in.nodes = nodes_.data()->position.data();
  in.pairs = pairs_.data();
  in.inner_along = inner_along_.data();
  in.inner_across = inner_across_.data();
  const std::size_t stride = 3 * kLanes * layout_.virtual_node_count;
  const auto apply_part = [&](std::size_t part) {
    const std::size_t first = part * kSlicesInPart;
    whole.functions.apply(
        layout_, in, {all_slices_.data() + first, std::min(kSlicesInPart, slices_.size() - first)},
        masses_.data(), out.data()->data(), virtual_sums_.data() + stride * part,
        dots_.data() + kLanes * part);
  };
  SerialRunner serial;
  (runner_ == nullptr ? serial : *runner_).run(parts(), apply_part);
  return std::accumulate(dots_.begin(), dots_.end(), 0.0) + add_couplings(contacts_, nodes_, out);
}

}  // namespace palpate::deformation
