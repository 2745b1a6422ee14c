#include "collision/near_surface.h"

#include <algorithm>
#include <numeric>

#include "modules/core/sort_unique.h"

namespace palpate::collision {
namespace {

/// Where nodes are in P, over the step.
struct NodeWays {
  const RelativeMotion& motion;
  const NodeArray &starts, &ends;

  explicit NodeWays(const OrganStep& step)
      : motion(step.motion), starts(step.start_positions()), ends(step.organ.positions()) {}
  Vec3 start(std::uint32_t node) const { return motion.start(starts[node]); }
  Vec3 end(std::uint32_t node) const { return motion.end(ends[node]); }
};

/// Appends nodes with their ways.
class TurnNodes {
 public:
  TurnNodes(const OrganStep& step, const WantedTriangles& wanted, std::vector<SweptNode>& nodes)
      : ways_(step), wanted_(wanted), nodes_(nodes) {
    nodes_.clear();
  }

  void operator()(std::uint32_t node) const {
    const Vec3 start = ways_.start(node), end = ways_.end(node);
    nodes_.push_back({start, end, (end - start).squaredNorm(), node, wanted_.is_sure(end)});
  }
  std::size_t count() const { return nodes_.size(); }
  bool is_wanted(const OrganStep& step, const NearSurface::Candidate& triangle) const {
    const auto& [x, y, z] = triangle.corners;
    return wanted_.is(step, {nodes_[x].index, nodes_[y].index, nodes_[z].index},
                      {&nodes_[x], &nodes_[y], &nodes_[z]});
  }

 private:
  const NodeWays ways_;
  const WantedTriangles& wanted_;
  std::vector<SweptNode>& nodes_;
};

/// Appends nodes where they end; of their ways only how long the longest is.
class TurnEnds {
 public:
  TurnEnds(const OrganStep& step, std::vector<NearSurface::EndNode>& nodes, double& travel_squared)
      : ways_(step), nodes_(nodes), travel_squared_(travel_squared) {
    nodes_.clear();
    travel_squared_ = 0;
  }

  void operator()(std::uint32_t node) const {
    const Vec3 end = ways_.end(node);
    travel_squared_ = std::max(travel_squared_, (end - ways_.start(node)).squaredNorm());
    nodes_.push_back({end, node});
  }
  std::size_t count() const { return nodes_.size(); }
  /// Floats told it.
  bool is_wanted(const OrganStep&, const NearSurface::Candidate&) const { return true; }

 private:
  const NodeWays ways_;
  std::vector<NearSurface::EndNode>& nodes_;
  double& travel_squared_;
};

}  // namespace

/// apart_ of nodes.
void NearSurface::find_apart(const OrganStep& step, std::span<const std::uint32_t> nodes,
                             const WantedTriangles& wanted) {
  const NodeArray &starts = step.start_positions(), &ends = step.organ.positions();
  const std::size_t rows = std::min(starts.floats().size(), ends.floats().size());
  const float *const start = starts.floats().data(), *const end = ends.floats().data();
  apart_.resize(nodes.size());
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const std::size_t first = 3 * std::size_t{nodes[i]};
    using Row = WantedTriangles::Row;
    apart_[i] = first + 3 < rows ? wanted.apart(Row(start + first), Row(end + first))
                                 : wanted.apart(starts[nodes[i]], ends[nodes[i]]);
  }
}

template <class Turn>
void NearSurface::open(const OrganStep& step, std::size_t block, const WantedTriangles& wanted,
                       const Turn& turn) {
  constexpr std::uint32_t kNotWanted = 0xffffffff;
  const auto own = step.organ.blocks().nodes_of(block);
  const auto triangles = step.organ.blocks().triangles_of(block);
  const auto corners = step.organ.blocks().corners_of(block);
  find_apart(step, own, wanted);
  place_.assign(own.size(), kNotWanted);
  maybe_.clear();
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    const auto& [a, b, c] = corners[i];
    if (!wanted.may_be(apart_[a], apart_[b], apart_[c])) continue;
    place_[a] = place_[b] = place_[c] = 0;
    maybe_.push_back(i);
  }
  for (std::size_t i = 0; i < own.size(); ++i) {
    if (place_[i] == kNotWanted) continue;
    place_[i] = static_cast<std::uint32_t>(turn.count());
    turn(own[i]);
  }
  for (const std::uint32_t i : maybe_) {
    const auto& [a, b, c] = corners[i];
    const Candidate near{triangles[i], {place_[a], place_[b], place_[c]}};
    if (wanted.told_by_floats() || turn.is_wanted(step, near)) candidates_.push_back(near);
  }
}

void NearSurface::find_blocks(const OrganStep& step, const WantedTriangles& wanted) {
  blocks_.clear();
  const OrganSurface& organ = step.organ;
  const auto may_hold = [&](const OrganSurface::Boxes& starts, const OrganSurface::Boxes& ends) {
    return [&](std::size_t i) { return wanted.may_be_in(step.motion, starts[i], ends[i]); };
  };
  geometry::visit_blocks(
      organ.blocks().count(), may_hold(organ.groups_at(step.start_version), organ.groups()),
      may_hold(organ.boxes_at(step.start_version), organ.boxes()),
      [&](std::size_t block) { blocks_.push_back(static_cast<std::uint32_t>(block)); });
}

void NearSurface::gather(const OrganStep& step, const Bounds& core, double reach) {
  const WantedTriangles wanted(step.motion, core, reach);
  find_blocks(step, wanted);
  open_blocks(step, wanted, TurnNodes(step, wanted, nodes_));
  sweep();
}

template <class Turn>
void NearSurface::open_blocks(const OrganStep& step, const WantedTriangles& wanted,
                              const Turn& turn) {
  candidates_.clear();
  for (const std::uint32_t block : blocks_) open(step, block, wanted, turn);
}

/// Of blocks in a row there are not many triangles: they are sorted digit by digit.
void NearSurface::sort_candidates() {
  constexpr unsigned kDigit = 8;
  if (candidates_.empty()) return;
  const auto [lowest, highest] = std::ranges::minmax(candidates_, {}, &Candidate::triangle);
  const std::uint32_t from = lowest.triangle, range = highest.triangle - from;
  sorted_.resize(candidates_.size());
  for (unsigned shift = 0; shift < 32 && range >> shift > 0; shift += kDigit) {
    const auto digit = [&](const Candidate& near) {
      return ((near.triangle - from) >> shift) & ((1u << kDigit) - 1);
    };
    std::array<std::uint32_t, 1u << kDigit> places{};
    for (const Candidate& near : candidates_) ++places[digit(near)];
    std::exclusive_scan(places.begin(), places.end(), places.begin(), 0u);
    for (const Candidate& near : candidates_) sorted_[places[digit(near)]++] = near;
    candidates_.swap(sorted_);
  }
}

void NearSurface::sweep() {
  sort_candidates();
  triangles_.resize(candidates_.size());  // of those before, nothing is left
  std::size_t count = 0;
  for (const Candidate& near : candidates_) {
    SweptTriangle& swept = triangles_[count];
    geometry::Triangle nodes;
    double squared = 0;
    for (int k = 0; k < 3; ++k) {
      const SweptNode& node = nodes_[near.corners[k]];
      nodes[k] = node.index;
      swept.start[k] = node.start;
      swept.end[k] = node.end;
      squared = std::max(squared, node.travel_squared);
    }
    count += swept.complete(near.triangle, nodes, squared);
  }
  triangles_.resize(count);
}

/// The nearest node of each cell, of all within reach at the step's end. Blocks that are near come
/// first, so that most of the others are not looked at.
/// @returns whether very many triangles begin at nodes within reach
bool NearSurface::find_places(const OrganStep& step, const Core& core,
                              const WantedTriangles& wanted) {
  const CoreAtEnd at_end(step.motion, core, wanted.reach());
  const Vec3 a = step.motion.to_world_at_end(core.a);
  const Vec3 to_b = step.motion.to_world_at_end(core.b) - a;
  grid_.begin(a.cwiseMin(a + to_b) - Vec3::Constant(wanted.reach()),
              to_b.cwiseAbs() + Vec3::Constant(2 * wanted.reach()));
  const auto within = static_cast<float>(wanted.reach_squared());
  nearest_first_.clear();
  for (const std::uint32_t block : blocks_) {
    const float squared = at_end.squared_distance(step.organ.boxes()[block]);
    if (squared <= within) nearest_first_.push_back({squared, block});
  }
  std::sort(nearest_first_.begin(), nearest_first_.end());
  std::size_t count = 0;
  for (const auto& [of_block, block] : nearest_first_) {
    const bool is_counted = count > kManyTriangles;
    if (is_counted && !grid_.would_take(step.organ.boxes()[block], of_block)) continue;
    const auto nodes = step.organ.blocks().nodes_of(block);
    within_.resize(nodes.size());
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const Four x = row_of(step.organ.positions(), nodes[i]);
      const float squared = at_end.squared_distance(x);
      within_[i] = squared <= within;
      if (within_[i]) grid_.take(x, squared, nodes[i]);
    }
    if (is_counted) continue;
    for (const auto& corners : step.organ.blocks().corners_of(block)) count += within_[corners[0]];
  }
  return count > kManyTriangles;
}

bool NearSurface::gather_front(const OrganStep& step, const Core& core, double reach) {
  const Bounds hull{core.a.cwiseMin(core.b), core.a.cwiseMax(core.b)};
  const WantedTriangles wanted(step.motion, hull, core.radius + reach);
  find_blocks(step, wanted);
  std::size_t most = 0;  // of the triangles within reach: few enough need not be counted
  for (const std::uint32_t block : blocks_) most += step.organ.blocks().corners_of(block).size();
  if (most <= kManyTriangles || !find_places(step, core, wanted)) {
    open_blocks(step, wanted, TurnNodes(step, wanted, nodes_));
    sweep();
    return false;
  }
  const WantedTriangles touching(step.motion, hull, core.radius);
  const auto &starts = step.organ.boxes_at(step.start_version), &ends = step.organ.boxes();
  std::erase_if(blocks_, [&](std::uint32_t block) {
    return !touching.may_be_in(step.motion, starts[block], ends[block]);
  });
  const auto open_and_add = [&](const auto& turn) {
    open_blocks(step, touching, turn);
    add_places(step, touching, turn);
  };
  if (touching.told_by_floats()) {
    open_and_add(TurnEnds(step, end_nodes_, end_travel_squared_));
    return true;
  }
  open_and_add(TurnNodes(step, touching, nodes_));
  sweep();
  return false;
}

void NearSurface::sweep_candidates(const OrganStep& step) {
  sort_candidates();
  triangles_.clear();
  SweptTriangle swept;
  for (const Candidate& candidate : candidates_) {
    if (step.sweep(candidate.triangle, swept)) triangles_.push_back(swept);
  }
}

/// One triangle at each node of the grid, and all around the nearest of them.
/// @param there  those are candidates already
template <class Turn>
void NearSurface::add_places(const OrganStep& step, const WantedTriangles& there,
                             const Turn& turn) {
  const auto nearest = std::ranges::min_element(grid_.places(), {}, &NodeGrid::Place::squared);
  at_places_.clear();
  for (const NodeGrid::Place& place : grid_.places()) {
    if (!place.is_taken()) continue;
    const auto around = step.organ.triangles_of_node(place.node);
    const auto some = around.first(&place == &*nearest ? around.size() : 1);
    at_places_.insert(at_places_.end(), some.begin(), some.end());
  }
  sort_unique(at_places_);
  for (const std::uint32_t t : at_places_) {
    const geometry::Triangle& nodes = step.organ.triangles()[t];
    if (there.told_by_floats() && there.is_told(step, nodes)) continue;
    const auto first = static_cast<std::uint32_t>(turn.count());
    for (const std::uint32_t node : nodes) turn(node);
    const Candidate candidate{t, {first, first + 1, first + 2}};
    if (!there.told_by_floats() && turn.is_wanted(step, candidate)) continue;
    candidates_.push_back(candidate);
  }
}

void NearSurface::gather_nodes(const OrganStep& step, const Bounds& core, double reach,
                               std::vector<std::uint32_t>& nodes) {
  const WantedTriangles wanted(step.motion, core, reach);
  find_blocks(step, wanted);
  seen_.assign(step.organ.node_count(), false);
  for (const std::uint32_t block : blocks_) {
    for (const std::uint32_t node : step.organ.blocks().nodes_of(block)) {
      if (seen_[node]) continue;
      seen_[node] = true;
      Bounds way;
      way.add(step.node_start(node));
      way.add(step.node_end(node));
      if (core.squared_distance(way) <= wanted.reach_squared()) nodes.push_back(node);
    }
  }
}

void NearSurface::add(const OrganStep& step, std::vector<std::uint32_t>& triangles) {
  if (triangles.empty()) return;
  sort_unique(triangles);
  const std::size_t there = triangles_.size();
  SweptTriangle swept;
  std::size_t at = 0;
  for (const std::uint32_t t : triangles) {
    while (at < there && triangles_[at].index < t) ++at;
    const bool is_there = at < there && triangles_[at].index == t;
    if (!is_there && step.sweep(t, swept)) triangles_.push_back(swept);
  }
  if (triangles_.size() == there) return;
  std::inplace_merge(
      triangles_.begin(), triangles_.begin() + static_cast<std::ptrdiff_t>(there), triangles_.end(),
      [](const SweptTriangle& a, const SweptTriangle& b) { return a.index < b.index; });
}

}  // namespace palpate::collision
