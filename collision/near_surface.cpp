#include "collision/near_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "modules/core/sort_unique.h"
#include "modules/core/tolerances.h"

namespace palpate::collision {
namespace {

using Four = Eigen::Array4f;

using Row = Eigen::Map<const Four>;  // of a box or of nodes: floats in a row

/// A node's x, y and z, and something finite.
Four row_of(const NodeArray& nodes, std::uint32_t node) {
  const std::size_t first = 3 * std::size_t{node};
  if (first + 3 < nodes.floats().size()) return Row(nodes.floats().data() + first);
  Four row = Four::Zero();
  row.head<3>() = nodes[node].cast<float>();
  return row;
}

bool is_bounded(const Bounds& box) { return (box.upper - box.lower).maxCoeff() < 2 * kWorldReach; }

}  // namespace

/// What a gathering asks of boxes.
struct NearSurface::Wanted {
  Bounds core_P, core_W;  ///< over the step
  bool bounded = true;
  double reach = 0;          ///< [m]
  double reach_squared = 0;  ///< [m²]

  Wanted(const RelativeMotion& motion, const Bounds& core, double beside_chord)
      : core_P(core), bounded(is_bounded(core)), reach(beside_chord + motion.chord_error()) {
    reach_squared = reach * reach;
    const double sure = std::max(0.0, reach * (1 - kRounding) - kRounding);
    sure_squared_ = sure * sure;
    if (!bounded) return;
    core_W = motion.swept(core);
    Bounds wide = core_W;
    wide.inflate(reach * (1 + kRounding) + kRounding);
    wide_.add(wide.lower);
    wide_.add(wide.upper);
    geometry::BlockBox in_floats;
    in_floats.add(core_W.lower);
    in_floats.add(core_W.upper);
    std::copy_n(in_floats.lower.data(), 3, lower_W_.data());
    std::copy_n(in_floats.upper.data(), 3, upper_W_.data());
    above_reach_squared_ = static_cast<float>(reach_squared * (1 + kRoundingOfFloats));
  }
  /// @param start, end  boxes of the block
  bool may_hold(const RelativeMotion& motion, const geometry::BlockBox& start,
                const geometry::BlockBox& end) const {
    if (bounded && !overlaps(start, end)) return false;
    Bounds both;
    both.add(start);
    both.add(end);
    if (bounded) return core_W.squared_distance(both) <= reach_squared;
    Bounds in_P = motion.seen(both);
    in_P.inflate(kDirectionless);  // turning it rounds
    return core_P.squared_distance(in_P) <= reach_squared;
  }

  /// How far the core is below and above a node's way through the world.
  Apart apart(const Vec3& start, const Vec3& end) const {
    geometry::BlockBox box;
    box.add(start);
    box.add(end);
    const auto& [x, y, z] = box.upper;
    return {lower_W_ - Four(x, y, z, 0), Row(box.lower.data()) - upper_W_};
  }
  Apart apart(const Row& start, const Row& end) const {
    return {lower_W_ - start.max(end), start.min(end) - upper_W_};
  }
  /// Holds of every triangle that is wanted, and of few others: in floats, in a few instructions.
  bool may_want(const Apart& x, const Apart& y, const Apart& z) const {
    const Four below = x.below.min(y.below).min(z.below);
    const Four above = x.above.min(y.above).min(z.above);
    return !bounded || below.max(above).max(0).square().sum() <= above_reach_squared_;
  }
  /// A node that is so near at the step's end makes its triangles wanted.
  bool is_sure(const Vec3& end) const {
    return core_P.squared_distance(Bounds{end, end}) <= sure_squared_;
  }
  /// A triangle; judged by its way through the world, too, as its block was.
  bool wants(const OrganStep& step, const geometry::Triangle& nodes,
             const std::array<const SweptNode*, 3>& swept) const {
    if (swept[0]->is_sure || swept[1]->is_sure || swept[2]->is_sure) return true;
    Bounds box_P, box_W;
    for (int k = 0; k < 3; ++k) {
      box_P.add(swept[k]->start);
      box_P.add(swept[k]->end);
      box_W.add(step.start_positions()[nodes[k]]);
      box_W.add(step.organ.positions()[nodes[k]]);
    }
    return core_P.squared_distance(box_P) <= reach_squared &&
           (!bounded || core_W.squared_distance(box_W) <= reach_squared);
  }

 private:
  /// Most blocks are far away: this costs a few instructions each.
  bool overlaps(const geometry::BlockBox& start, const geometry::BlockBox& end) const {
    const Four lower = Row(start.lower.data()).min(Row(end.lower.data()));
    const Four upper = Row(start.lower.data() + 2).max(Row(end.lower.data() + 2));
    const Four lowest(wide_.upper[0], wide_.upper[1], wide_.upper[2], kFar);
    const Four highest(-kFar, wide_.lower[0], wide_.lower[1], wide_.lower[2]);
    return (lower <= lowest).all() && (upper >= highest).all();
  }

  static constexpr float kFar = std::numeric_limits<float>::infinity();
  static constexpr double kRounding = 1e-12;         // [m], and relative
  static constexpr double kRoundingOfFloats = 1e-6;  // relative
  geometry::BlockBox wide_;                          ///< core_W and the reach
  double sure_squared_ = 0;                          ///< [m²]
  // core_W and, along no axis, anything; a little more than the reach: for apart().
  Four lower_W_ = Four::Constant(-kFar), upper_W_ = Four::Constant(kFar);
  float above_reach_squared_ = 0;
};

/// apart_ of nodes.
void NearSurface::find_apart(const OrganStep& step, std::span<const std::uint32_t> nodes,
                             const Wanted& wanted) {
  const NodeArray &starts = step.start_positions(), &ends = step.organ.positions();
  const std::size_t rows = std::min(starts.floats().size(), ends.floats().size());
  const float *const start = starts.floats().data(), *const end = ends.floats().data();
  apart_.resize(nodes.size());
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const std::size_t first = 3 * std::size_t{nodes[i]};
    apart_[i] = first + 3 < rows ? wanted.apart(Row(start + first), Row(end + first))
                                 : wanted.apart(starts[nodes[i]], ends[nodes[i]]);
  }
}

void NearSurface::open(const OrganStep& step, std::size_t block, const Wanted& wanted) {
  constexpr std::uint32_t kNotWanted = 0xffffffff;
  const auto own = step.organ.blocks().nodes_of(block);
  const auto triangles = step.organ.blocks().triangles_of(block);
  const auto corners = step.organ.blocks().corners_of(block);
  find_apart(step, own, wanted);
  place_.assign(own.size(), kNotWanted);
  maybe_.clear();
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    const auto& [a, b, c] = corners[i];
    if (!wanted.may_want(apart_[a], apart_[b], apart_[c])) continue;
    place_[a] = place_[b] = place_[c] = 0;
    maybe_.push_back(i);
  }
  for (std::size_t i = 0; i < own.size(); ++i) {
    if (place_[i] != kNotWanted) place_[i] = turn(step, own[i], wanted);
  }
  for (const std::uint32_t i : maybe_) {
    const auto& [a, b, c] = corners[i];
    const Near near{triangles[i], {place_[a], place_[b], place_[c]}};
    const auto& [x, y, z] = near.corners;
    if (wanted.wants(step, {own[a], own[b], own[c]}, {&nodes_[x], &nodes_[y], &nodes_[z]})) {
      near_.push_back(near);
    }
  }
}

/// @returns its place in nodes_
std::uint32_t NearSurface::turn(const OrganStep& step, std::uint32_t node, const Wanted& wanted) {
  const Vec3 start = step.node_start(node), end = step.node_end(node);
  nodes_.push_back({start, end, (end - start).squaredNorm(), node, wanted.is_sure(end)});
  return static_cast<std::uint32_t>(nodes_.size() - 1);
}

void NearSurface::find_blocks(const OrganStep& step, const Wanted& wanted) {
  blocks_.clear();
  const OrganSurface& organ = step.organ;
  const auto may_hold = [&](const OrganSurface::Boxes& starts, const OrganSurface::Boxes& ends) {
    return [&](std::size_t i) { return wanted.may_hold(step.motion, starts[i], ends[i]); };
  };
  geometry::visit_blocks(
      organ.blocks().count(), may_hold(organ.groups_at(step.start_version), organ.groups()),
      may_hold(organ.boxes_at(step.start_version), organ.boxes()),
      [&](std::size_t block) { blocks_.push_back(static_cast<std::uint32_t>(block)); });
}

void NearSurface::gather(const OrganStep& step, const Bounds& core, double reach) {
  const Wanted wanted(step.motion, core, reach);
  find_blocks(step, wanted);
  open_blocks(step, wanted);
  sweep();
}

void NearSurface::open_blocks(const OrganStep& step, const Wanted& wanted) {
  nodes_.clear();
  near_.clear();
  for (const std::uint32_t block : blocks_) open(step, block, wanted);
}

/// Of blocks in a row there are not many triangles: they are sorted digit by digit.
void NearSurface::sort_near() {
  constexpr unsigned kDigit = 8;
  if (near_.empty()) return;
  const auto [lowest, highest] = std::ranges::minmax(near_, {}, &Near::triangle);
  const std::uint32_t from = lowest.triangle, range = highest.triangle - from;
  sorted_.resize(near_.size());
  for (unsigned shift = 0; shift < 32 && range >> shift > 0; shift += kDigit) {
    const auto digit = [&](const Near& near) {
      return ((near.triangle - from) >> shift) & ((1u << kDigit) - 1);
    };
    std::array<std::uint32_t, 1u << kDigit> places{};
    for (const Near& near : near_) ++places[digit(near)];
    std::exclusive_scan(places.begin(), places.end(), places.begin(), 0u);
    for (const Near& near : near_) sorted_[places[digit(near)]++] = near;
    near_.swap(sorted_);
  }
}

/// Fills triangles_ with those of near_, each once whether it is there once or twice.
void NearSurface::sweep() {
  sort_near();
  const auto last = std::unique(near_.begin(), near_.end(), [](const Near& a, const Near& b) {
    return a.triangle == b.triangle;
  });
  near_.erase(last, near_.end());
  triangles_.resize(near_.size());  // of those before, nothing is left
  std::size_t count = 0;
  for (const Near& near : near_) {
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

/// Of a grid around a round core at the step's end, as far as a reach. It says which of very many
/// nodes stand for others: floats tell that well enough.
struct NearSurface::Grid {
  Grid(const RelativeMotion& motion, const Core& core, double reach) : is_point(core.is_point()) {
    const Vec3 from = motion.to_world_at_end(core.a);
    const Vec3 to_b = motion.to_world_at_end(core.b) - from;
    const Vec3 corner = from.cwiseMin(from + to_b) - Vec3::Constant(reach);
    const Vec3 size = to_b.cwiseAbs() + Vec3::Constant(2 * reach);
    a.head<3>() = from.cast<float>();
    along.head<3>() = to_b.cast<float>();
    if (!is_point) per_length.head<3>() = (to_b / to_b.squaredNorm()).cast<float>();
    lower.head<3>() = corner.cast<float>();
    per_size.head<3>() = (double{kCells} / size.array()).cast<float>();
    hull.add(from);
    hull.add(from + to_b);
    rounding = 1e-6 * (from.norm() + size.norm());
  }
  /// Distance of the core from a node's x, y and z [m²].
  float squared_distance(const Four& x) const {
    const Four from_a = (x - a) * axes;
    if (is_point) return from_a.square().sum();
    const float at = std::clamp((per_length * from_a).sum(), 0.0f, 1.0f);
    return (from_a - at * along).square().sum();
  }
  /// At most that of any node in the box [m²].
  float squared_distance(const geometry::BlockBox& box) const {
    const double at_least = std::sqrt(hull.squared_distance(box)) - rounding;
    return static_cast<float>(at_least > 0 ? at_least * at_least : 0);
  }
  Eigen::Array4i cell_along(const Four& x) const {
    return ((x - lower) * per_size).max(0).min(kCells - 1).cast<int>();
  }
  static std::size_t place_of(const Eigen::Array4i& cell) {
    return static_cast<std::size_t>((cell[0] * int{kCells} + cell[1]) * int{kCells} + cell[2]);
  }
  /// Whether any cell of the box asks for something as near.
  bool any_cell(const geometry::BlockBox& box, float squared, const Places& places) const {
    const Eigen::Array4i first = cell_along({box.lower[0], box.lower[1], box.lower[2], 0});
    const Eigen::Array4i last = cell_along({box.upper[0], box.upper[1], box.upper[2], 0});
    for (Eigen::Array4i at = first; at[0] <= last[0]; ++at[0]) {
      for (at[1] = first[1]; at[1] <= last[1]; ++at[1]) {
        for (at[2] = first[2]; at[2] <= last[2]; ++at[2]) {
          if (squared <= places[place_of(at)].squared) return true;
        }
      }
    }
    return false;
  }

  bool is_point;
  Four axes{1, 1, 1, 0}, a = Four::Zero(), along = a, per_length = a, lower = a, per_size = a;
  Bounds hull;
  double rounding = 0;  ///< of distances [m]
};

/// The nearest node of each cell, of all within reach at the step's end. Blocks that are near come
/// first, so that most of the others are not looked at.
/// @returns whether very many triangles begin at nodes within reach
bool NearSurface::find_places(const OrganStep& step, const Core& core, const Wanted& wanted) {
  const Grid grid(step.motion, core, wanted.reach);
  const NodeArray& ends = step.organ.positions();
  const auto within = static_cast<float>(wanted.reach_squared);
  places_.fill({std::numeric_limits<float>::infinity(), 0});
  nearest_first_.clear();
  for (const std::uint32_t block : blocks_) {
    const float squared = grid.squared_distance(step.organ.boxes()[block]);
    if (squared <= within) nearest_first_.push_back({squared, block});
  }
  std::sort(nearest_first_.begin(), nearest_first_.end());
  std::size_t count = 0;
  for (const auto& [of_block, block] : nearest_first_) {
    const bool is_counted = count > kManyTriangles;
    if (is_counted && !grid.any_cell(step.organ.boxes()[block], of_block, places_)) continue;
    const auto nodes = step.organ.blocks().nodes_of(block);
    within_.resize(nodes.size());
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const std::uint32_t node = nodes[i];
      const Four x = row_of(ends, node);
      const float squared = grid.squared_distance(x);
      within_[i] = squared <= within;
      if (!within_[i]) continue;
      Place& nearest = places_[Grid::place_of(grid.cell_along(x))];
      if (squared < nearest.squared || (squared == nearest.squared && node < nearest.node)) {
        nearest = {squared, node};
      }
    }
    if (is_counted) continue;
    for (const auto& corners : step.organ.blocks().corners_of(block)) count += within_[corners[0]];
  }
  return count > kManyTriangles;
}

void NearSurface::gather_front(const OrganStep& step, const Core& core, double reach) {
  const Bounds hull{core.a.cwiseMin(core.b), core.a.cwiseMax(core.b)};
  const Wanted wanted(step.motion, hull, core.radius + reach);
  find_blocks(step, wanted);
  std::size_t most = 0;  // of the triangles within reach: few enough need not be counted
  for (const std::uint32_t block : blocks_) most += step.organ.blocks().corners_of(block).size();
  if (most <= kManyTriangles || !find_places(step, core, wanted)) {
    open_blocks(step, wanted);
    return sweep();
  }
  const Wanted touching(step.motion, hull, core.radius);
  const auto &starts = step.organ.boxes_at(step.start_version), &ends = step.organ.boxes();
  std::erase_if(blocks_, [&](std::uint32_t block) {
    return !touching.may_hold(step.motion, starts[block], ends[block]);
  });
  open_blocks(step, touching);
  const auto nearest = std::ranges::min_element(places_, {}, &Place::squared);
  for (const Place& place : places_) {
    if (!(place.squared <= wanted.reach_squared)) continue;
    const auto around = step.organ.triangles_of_node(place.node);
    for (const std::uint32_t t : around.first(&place == &*nearest ? around.size() : 1)) {
      const auto& [a, b, c] = step.organ.triangles()[t];
      near_.push_back({t, {turn(step, a, wanted), turn(step, b, wanted), turn(step, c, wanted)}});
    }
  }
  sweep();
}

void NearSurface::gather_nodes(const OrganStep& step, const Bounds& core, double reach,
                               std::vector<std::uint32_t>& nodes) {
  const Wanted wanted(step.motion, core, reach);
  find_blocks(step, wanted);
  seen_.assign(step.organ.node_count(), false);
  for (const std::uint32_t block : blocks_) {
    for (const std::uint32_t node : step.organ.blocks().nodes_of(block)) {
      if (seen_[node]) continue;
      seen_[node] = true;
      Bounds way;
      way.add(step.node_start(node));
      way.add(step.node_end(node));
      if (core.squared_distance(way) <= wanted.reach_squared) nodes.push_back(node);
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
