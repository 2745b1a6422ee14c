#include "deformation/elements/kernel/element_parts_builder.h"

#include <algorithm>
#include <bit>
#include <numeric>

namespace palpate::deformation {
namespace {

using kernel::kGroupPairs;
using kernel::kTetrahedronLanes;

/// Tetrahedra that are not halved further.
constexpr std::size_t kLeaf = 4 * kTetrahedronLanes;

/// Corners a, b of an edge and c, d opposite, turning with it.
constexpr std::array<std::array<std::size_t, 4>, 6> kRings{
    {{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2}, {1, 2, 0, 3}, {1, 3, 2, 0}, {2, 3, 0, 1}}};

/// 2⁶⁴ over the golden ratio: multiples scatter evenly.
constexpr std::uint64_t kFibonacci = 0x9e3779b97f4a7c15;

/// Sebastiano Vigna's splitmix64.
std::uint64_t scrambled(std::uint64_t x) {
  x += kFibonacci;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
  x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
  return x ^ (x >> 31);
}

/// 0 … count − 1 in steps of about three eighths: what stood side by side, and adds to the same
/// nodes, stands apart, and does not wait for each other.
std::vector<std::size_t> spread(std::size_t count) {
  std::size_t stride = std::max<std::size_t>(1, 3 * count / 8);
  while (std::gcd(stride, count) > 1) ++stride;
  std::vector<std::size_t> order(count);
  for (std::size_t k = 1; k < count; ++k) order[k] = (order[k - 1] + stride) % count;
  return order;
}

}  // namespace

ElementParts::ElementParts(const LinearTetrahedra& mesh) {
  ElementPartsBuilder(mesh, *this).build();
}

void ElementPartsBuilder::build() {
  order_.reserve(mesh_.size());
  for (std::uint32_t e = 0; e < mesh_.size(); ++e) order_.push_back({mesh_.centres[e], e});
  for (std::uint32_t node = 0; node < mesh_.node_count; ++node) {
    scrambled_.push_back(scrambled(node));
  }
  halve(0, order_.size());
  numbers_.assign(mesh_.node_count, kNone);
  for (Part& part : parts_) {
    number_nodes(part);
    find_edges(part);
    for (const std::uint32_t node : part.nodes) numbers_[node] = kNone;
  }
  take_slots();
  find_owners();
  for (std::size_t index = 0; index < parts_.size(); ++index) place_rows(index);
  for (std::size_t index = 0; index < parts_.size(); ++index) place_spilt(index);
  is_open_.assign(mesh_.node_count, false);
  for (std::size_t index = 0; index < parts_.size(); ++index) take_open_pairs(index);
  for (std::size_t index = 0; index < parts_.size(); ++index) {
    take_merges(index);
    take_tetrahedra(index);
  }
  point_parts();
}

/// Halves of one size become parts together, whatever the number of tetrahedra is exactly.
void ElementPartsBuilder::halve(std::size_t first, std::size_t last) {
  if (last - first > ElementParts::kMostTetrahedra) {
    const std::size_t middle = cut(first, last);
    halve(first, middle);
    halve(middle, last);
    return;
  }
  parts_.emplace_back().first = first;
  parts_.back().last = last;
  std::vector<std::array<std::size_t, 2>> left{{first, last}};
  while (!left.empty()) {
    const auto [from, to] = left.back();
    left.pop_back();
    if (to - from <= kLeaf) {
      std::ranges::sort(std::span(order_).subspan(from, to - from), {}, &Placed::tetrahedron);
      continue;
    }
    const std::size_t middle = cut(from, to);
    left.push_back({middle, to});
    left.push_back({from, middle});
  }
}

std::size_t ElementPartsBuilder::cut(std::size_t first, std::size_t last) {
  const std::span<Placed> cut_up = std::span(order_).subspan(first, last - first);
  Vec3 low = cut_up.front().centre, high = low;
  for (const Placed& placed : cut_up) {
    low = low.cwiseMin(placed.centre);
    high = high.cwiseMax(placed.centre);
  }
  int axis = 0;
  (high - low).maxCoeff(&axis);
  const std::size_t middle = first + (last - first) / 2;
  std::ranges::nth_element(cut_up, cut_up.begin() + static_cast<std::ptrdiff_t>(middle - first),
                           [axis](const Placed& a, const Placed& b) {
                             return a.centre[axis] != b.centre[axis]
                                        ? a.centre[axis] < b.centre[axis]
                                        : a.tetrahedron < b.tetrahedron;
                           });
  return middle;
}

void ElementPartsBuilder::number_nodes(Part& part) {
  part.corners.reserve(part.last - part.first);
  for (std::size_t k = part.first; k < part.last; ++k) {
    auto& corners = part.corners.emplace_back();
    for (std::size_t c = 0; c < 4; ++c) {
      const std::uint32_t node = mesh_.corners[order_[k].tetrahedron][c];
      if (numbers_[node] == kNone) {
        numbers_[node] = static_cast<std::uint32_t>(part.nodes.size());
        part.nodes.push_back(node);
      }
      corners[c] = numbers_[node];
    }
  }
}

void ElementPartsBuilder::find_edges(Part& part) {
  part.edges.reserve(8 * part.nodes.size());
  part.edges_of.reserve(part.corners.size());
  // More places than a part can have edges, six for each tetrahedron.
  remembered_bits_ = std::bit_width(6 * part.corners.size());
  remembered_.assign(std::size_t{1} << remembered_bits_, {});
  for (const auto& corners : part.corners) {
    auto& edges = part.edges_of.emplace_back();
    for (std::size_t e = 0; e < 6; ++e) {
      const auto [a, b, c, d] = kRings[e];
      edges[e] = edge_between(part, corners[a], corners[b]);
      const std::uint64_t from = scrambled_[part.nodes[corners[c]]],
                          to = scrambled_[part.nodes[corners[d]]];
      // Seen from its lower node in the mesh, so that parts add up.
      const bool ahead = part.nodes[corners[a]] < part.nodes[corners[b]];
      part.edges[edges[e]].ring += ahead ? to - from : from - to;
    }
  }
}

std::uint32_t ElementPartsBuilder::edge_between(Part& part, std::uint32_t a, std::uint32_t b) {
  const auto [low, high] = std::minmax(a, b);
  static_assert(4 * ElementParts::kMostTetrahedra < 1 << 16);
  const std::uint32_t nodes = low << 16 | high;
  std::uint64_t place = nodes * kFibonacci >> (64 - remembered_bits_);
  while (remembered_[place].edge != kNone && remembered_[place].nodes != nodes) {
    place = (place + 1) % remembered_.size();
  }
  if (remembered_[place].edge == kNone) {
    remembered_[place] = {nodes, static_cast<std::uint32_t>(part.edges.size())};
    Edge& edge = part.edges.emplace_back();
    edge.low = low;
    edge.high = high;
  }
  return remembered_[place].edge;
}

void ElementPartsBuilder::take_slots() {
  auto& firsts = out_.first_slots_;
  firsts.assign(mesh_.node_count + 1, 0);
  for (const Part& part : parts_) {
    auto& made = out_.parts_.emplace_back();
    made.first_slot = static_cast<std::uint32_t>(out_.nodes_.size());
    made.slot_count = static_cast<std::uint32_t>(part.nodes.size());
    made.tetrahedron_count = static_cast<std::uint32_t>(part.corners.size());
    out_.nodes_.insert(out_.nodes_.end(), part.nodes.begin(), part.nodes.end());
    out_.nodes_.push_back(ElementParts::kNoNode);
    for (const std::uint32_t node : part.nodes) ++firsts[node + 1];
  }
  std::partial_sum(firsts.begin(), firsts.end(), firsts.begin());
  out_.slots_.resize(firsts.back());
  std::vector<std::uint32_t> next(firsts.begin(), firsts.end() - 1);
  for (std::uint32_t slot = 0; slot < out_.nodes_.size(); ++slot) {
    if (out_.nodes_[slot] != ElementParts::kNoNode) out_.slots_[next[out_.nodes_[slot]]++] = slot;
  }
}

/// The first part that has an edge owns it, and its ring becomes that of all parts.
void ElementPartsBuilder::find_owners() {
  std::vector<Meeting> meetings;
  for (std::uint32_t p = 0; p < parts_.size() && parts_.size() > 1; ++p) {
    for (std::uint32_t e = 0; e < parts_[p].edges.size(); ++e) {
      const Edge& edge = parts_[p].edges[e];
      const std::uint32_t a = parts_[p].nodes[edge.low], b = parts_[p].nodes[edge.high];
      if (out_.slots(a).size() == 1 || out_.slots(b).size() == 1) continue;
      const auto [low, high] = std::minmax(a, b);
      meetings.push_back({std::uint64_t{low} << 32 | high, p, e});
    }
  }
  std::sort(meetings.begin(), meetings.end());
  for (std::size_t k = 1, owner = 0; k < meetings.size(); ++k) {
    if (meetings[k].key != meetings[owner].key) owner = k;
    if (owner == k) continue;
    Edge& edge = parts_[meetings[k].part].edges[meetings[k].edge];
    edge.owning_part = meetings[owner].part;
    edge.owning_edge = meetings[owner].edge;
    parts_[edge.owning_part].edges[edge.owning_edge].ring += edge.ring;
  }
}

/// A node takes its edges with those before it that they have left, and so many of the others that
/// its groups are full.
std::vector<ElementPartsBuilder::Group> ElementPartsBuilder::groups_of(const Part& part) const {
  std::vector<std::uint32_t> firsts(part.nodes.size() + 1, 0);
  for (const Edge& edge : part.edges) {
    if (edge.owning_part == kNone) ++firsts[edge.low + 1], ++firsts[edge.high + 1];
  }
  std::partial_sum(firsts.begin(), firsts.end(), firsts.begin());
  std::vector<std::uint32_t> around(firsts.back()), next(firsts.begin(), firsts.end() - 1);
  for (std::uint32_t e = 0; e < part.edges.size(); ++e) {
    if (part.edges[e].owning_part != kNone) continue;
    around[next[part.edges[e].low]++] = e;
    around[next[part.edges[e].high]++] = e;
  }
  std::vector<Group> groups;
  groups.reserve(part.edges.size() / kGroupPairs + part.nodes.size());
  std::vector<bool> taken(part.edges.size(), false);
  std::vector<std::uint32_t> left, ahead;
  for (std::uint32_t i = 0; i < part.nodes.size(); ++i) {
    left.clear();
    ahead.clear();
    for (std::uint32_t k = firsts[i]; k < firsts[i + 1]; ++k) {
      if (taken[around[k]]) continue;
      (part.edges[around[k]].high == i ? left : ahead).push_back(around[k]);
    }
    std::ranges::sort(ahead, {}, [&](std::uint32_t e) { return part.edges[e].high; });
    const std::size_t full = (left.size() + ahead.size()) / kGroupPairs * kGroupPairs;
    if (full > left.size()) {
      left.insert(left.end(), ahead.begin(),
                  ahead.begin() + static_cast<std::ptrdiff_t>(full - left.size()));
    }
    for (std::size_t k = 0; k < left.size(); ++k) {
      if (k % kGroupPairs == 0) groups.emplace_back().row = i;
      groups.back().edges[k % kGroupPairs] = left[k];
      taken[left[k]] = true;
    }
  }
  return groups;
}

void ElementPartsBuilder::place_rows(std::size_t index) {
  Part& part = parts_[index];
  kernel::ElementPart& made = out_.parts_[index];
  made.first_group = static_cast<std::uint32_t>(out_.group_count_);
  first_columns_.push_back(out_.columns_.size());
  first_rows_.push_back(out_.rows_.size());
  const std::vector<Group> groups = groups_of(part);
  auto pair = static_cast<std::uint32_t>(kGroupPairs * made.first_group);
  for (const std::size_t k : spread(groups.size())) {
    out_.rows_.push_back(4 * (made.first_slot + groups[k].row));
    for (const std::uint32_t e : groups[k].edges) {
      std::uint32_t column = made.slot_count;
      if (e != kNone) {
        Edge& edge = part.edges[e];
        edge.row_is_high = edge.high == groups[k].row;
        edge.pair = pair;
        column = edge.row_is_high ? edge.low : edge.high;
      }
      out_.columns_.push_back(4 * (made.first_slot + column));
      ++pair;
    }
  }
  made.group_count = static_cast<std::uint32_t>(groups.size());
  const auto spilt = static_cast<std::size_t>(std::ranges::count_if(
      part.edges, [](const Edge& edge) { return edge.owning_part != kNone; }));
  made.spilt_groups = static_cast<std::uint32_t>((spilt + kGroupPairs - 1) / kGroupPairs);
  out_.group_count_ += made.group_count + made.spilt_groups;
}

/// Behind the rows, the way round they are where they will be added.
void ElementPartsBuilder::place_spilt(std::size_t index) {
  Part& part = parts_[index];
  const kernel::ElementPart& made = out_.parts_[index];
  auto pair = static_cast<std::uint32_t>(kGroupPairs * (made.first_group + made.group_count));
  for (Edge& edge : part.edges) {
    if (edge.owning_part == kNone) continue;
    const Part& owner = parts_[edge.owning_part];
    const Edge& there = owner.edges[edge.owning_edge];
    const std::uint32_t row = owner.nodes[there.row_is_high ? there.high : there.low];
    edge.row_is_high = part.nodes[edge.high] == row;
    edge.pair = pair++;
  }
}

void ElementPartsBuilder::take_open_pairs(std::size_t index) {
  kernel::ElementPart& made = out_.parts_[index];
  made.first_open = out_.open_pairs_.size();
  std::vector<kernel::OpenPair> pairs;
  for (const Edge& edge : parts_[index].edges) {
    if (edge.owning_part != kNone || edge.ring == 0) continue;
    is_open_[parts_[index].nodes[edge.low]] = is_open_[parts_[index].nodes[edge.high]] = true;
    std::uint32_t row = 4 * (made.first_slot + edge.low);
    std::uint32_t column = 4 * (made.first_slot + edge.high);
    if (edge.row_is_high) std::swap(row, column);
    pairs.push_back({row, column, edge.pair});
  }
  for (const std::size_t k : spread(pairs.size())) out_.open_pairs_.push_back(pairs[k]);
  made.open_count = pairs.size();
}

void ElementPartsBuilder::take_merges(std::size_t index) {
  kernel::ElementPart& made = out_.parts_[index];
  first_pair_merges_.push_back(out_.pair_merges_.size());
  for (const Part& part : parts_) {
    for (const Edge& edge : part.edges) {
      if (edge.owning_part != index) continue;
      out_.pair_merges_.push_back({parts_[index].edges[edge.owning_edge].pair, edge.pair});
    }
  }
  first_node_merges_.push_back(out_.node_merges_.size());
  first_owned_.push_back(out_.owned_.size());
  first_shared_.push_back(out_.shared_.size());
  first_open_slots_.push_back(out_.open_slots_.size());
  for (std::uint32_t slot = made.first_slot; slot < made.first_slot + made.slot_count; ++slot) {
    const auto slots = out_.slots(out_.nodes_[slot]);
    const std::uint32_t node = out_.nodes_[slot];
    if (slots.size() > 1) {
      out_.shared_.push_back({slot, out_.first_slots_[node], out_.first_slots_[node + 1]});
    }
    if (slots[0] != slot) continue;
    out_.owned_.push_back(slot);
    if (is_open_[node]) out_.open_slots_.push_back(slot);
    for (const std::uint32_t other : slots.subspan(1)) out_.node_merges_.push_back({slot, other});
  }
  made.pair_merge_count = out_.pair_merges_.size() - first_pair_merges_.back();
  made.node_merge_count = out_.node_merges_.size() - first_node_merges_.back();
  made.open_slot_count = out_.open_slots_.size() - first_open_slots_.back();
  made.shared_count = out_.shared_.size() - first_shared_.back();
  made.owned_count = out_.owned_.size() - first_owned_.back();
}

void ElementPartsBuilder::take_tetrahedra(std::size_t index) {
  const Part& part = parts_[index];
  kernel::ElementPart& made = out_.parts_[index];
  made.first_batch = out_.batch_count();
  made.batch_count = (part.corners.size() + kTetrahedronLanes - 1) / kTetrahedronLanes;
  const std::size_t batches = made.first_batch + made.batch_count;
  out_.rest_volumes_.resize(batches * kTetrahedronLanes);
  out_.corners_.resize(4 * out_.rest_volumes_.size());
  out_.pairs_.resize(6 * out_.rest_volumes_.size());
  out_.flips_.resize(6 * out_.rest_volumes_.size());
  out_.gradients_.resize(9 * out_.rest_volumes_.size());
  for (std::size_t k = 0; k < made.batch_count * kTetrahedronLanes; ++k) {
    const std::size_t own = std::min(k, part.corners.size() - 1),
                      e = order_[part.first + own].tetrahedron;
    const std::size_t batch = made.first_batch + k / kTetrahedronLanes,
                      lane = k % kTetrahedronLanes;
    const auto place = [&](std::size_t rows, std::size_t row) {
      return (batch * rows + row) * kTetrahedronLanes + lane;
    };
    out_.rest_volumes_[place(1, 0)] = mesh_.volumes[e];
    for (std::size_t c = 0; c < 4; ++c) {
      out_.corners_[place(4, c)] = 4 * (made.first_slot + part.corners[own][c]);
    }
    for (std::size_t n = 0; n < 9; ++n) {
      out_.gradients_[place(9, n)] =
          mesh_.gradients[e](static_cast<int>(n % 3), static_cast<int>(n / 3) + 1);
    }
    for (std::size_t n = 0; n < 6; ++n) {
      const Edge& edge = part.edges[part.edges_of[own][n]];
      const std::uint32_t row = edge.row_is_high ? edge.high : edge.low;
      out_.pairs_[place(6, n)] = edge.pair;
      out_.flips_[place(6, n)] = part.corners[own][kRings[n][0]] == row ? 0.0f : 1.0f;
    }
  }
}

void ElementPartsBuilder::point_parts() {
  for (std::size_t index = 0; index < parts_.size(); ++index) {
    kernel::ElementPart& made = out_.parts_[index];
    made.rows = out_.rows_.data() + first_rows_[index];
    made.columns = out_.columns_.data() + first_columns_[index];
    made.open_pairs = out_.open_pairs_.data() + made.first_open;
    made.pair_merges = out_.pair_merges_.data() + first_pair_merges_[index];
    made.node_merges = out_.node_merges_.data() + first_node_merges_[index];
    made.open_slots = out_.open_slots_.data() + first_open_slots_[index];
    made.nodes = out_.nodes_.data();
    made.node_slots = out_.slots_.data();
    made.shared = out_.shared_.data() + first_shared_[index];
    made.owned = out_.owned_.data() + first_owned_[index];
  }
}

}  // namespace palpate::deformation
