#include "collision/near_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "modules/core/sort_unique.h"
#include "modules/core/tolerances.h"

namespace palpate::collision {
namespace {

Bounds box_of(const Vec3& a, const Vec3& b) { return {a.cwiseMin(b), a.cwiseMax(b)}; }

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
    if (!bounded) return;
    core_W = motion.swept(core);
    Bounds wide = core_W;
    wide.inflate(reach * (1 + kRounding) + kRounding);
    wide_.add(wide.lower);
    wide_.add(wide.upper);
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

  /// A triangle; judged by its way through the world, too, as its block was.
  bool may_hold(const SweptNode& x, const SweptNode& y, const SweptNode& z) const {
    return squared_distance(core_P, x.box, y.box, z.box) <= reach_squared &&
           (!bounded || squared_distance(core_W, x.box_W, y.box_W, z.box_W) <= reach_squared);
  }

 private:
  /// Most blocks are far away: this costs a few instructions each.
  bool overlaps(const geometry::BlockBox& start, const geometry::BlockBox& end) const {
    using Four = Eigen::Map<const Eigen::Array4f>;  // a box is six floats in a row
    const Eigen::Array4f lower = Four(start.lower.data()).min(Four(end.lower.data()));
    const Eigen::Array4f upper = Four(start.lower.data() + 2).max(Four(end.lower.data() + 2));
    const Eigen::Array4f lowest(wide_.upper[0], wide_.upper[1], wide_.upper[2], kFar);
    const Eigen::Array4f highest(-kFar, wide_.lower[0], wide_.lower[1], wide_.lower[2]);
    return (lower <= lowest).all() && (upper >= highest).all();
  }

  /// From what holds three boxes.
  static double squared_distance(const Bounds& from, const Bounds& x, const Bounds& y,
                                 const Bounds& z) {
    const auto below = from.lower - x.upper.cwiseMax(y.upper).cwiseMax(z.upper);
    const auto above = x.lower.cwiseMin(y.lower).cwiseMin(z.lower) - from.upper;
    return below.cwiseMax(above).cwiseMax(0).squaredNorm();
  }

  static constexpr float kFar = std::numeric_limits<float>::infinity();
  static constexpr double kRounding = 1e-12;  // [m], and relative
  geometry::BlockBox wide_;                   ///< core_W and the reach
};

void NearSurface::open(const OrganStep& step, std::size_t block, const Wanted& wanted) {
  const NodeArray &starts = step.start_positions(), &ends = step.organ.positions();
  const geometry::SurfaceBlocks& blocks = step.organ.blocks();
  const auto first = static_cast<std::uint32_t>(nodes_.size());
  Bounds all;
  for (const std::uint32_t node : blocks.nodes_of(block)) {
    const Vec3 start_W = starts[node], end_W = ends[node];
    const Vec3 start = step.motion.start(start_W), end = step.motion.end(end_W);
    const SweptNode& swept = nodes_.emplace_back(SweptNode{
        start, end, box_of(start, end), box_of(start_W, end_W), (end - start).squaredNorm()});
    all.add(swept.box.lower);
    all.add(swept.box.upper);
  }
  if (wanted.core_P.squared_distance(all) > wanted.reach_squared) {
    nodes_.resize(first);
    return;
  }
  const auto triangles = blocks.triangles_of(block);
  const auto corners = blocks.corners_of(block);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const auto [a, b, c] = corners[i];
    const SweptNode &x = nodes_[first + a], &y = nodes_[first + b], &z = nodes_[first + c];
    if (!wanted.may_hold(x, y, z)) continue;
    near_.push_back({triangles[i], {first + a, first + b, first + c}});
  }
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
  gather_from_blocks(step, wanted);
}

void NearSurface::gather_from_blocks(const OrganStep& step, const Wanted& wanted) {
  nodes_.clear();
  near_.clear();
  triangles_.clear();
  for (const std::uint32_t block : blocks_) open(step, block, wanted);
  std::sort(near_.begin(), near_.end(),
            [](const Near& a, const Near& b) { return a.triangle < b.triangle; });
  for (const Near& near : near_) {
    const geometry::Triangle& nodes = step.organ.triangles()[near.triangle];
    SweptTriangle& swept = triangles_.emplace_back();
    double squared = 0;
    for (int k = 0; k < 3; ++k) {
      const SweptNode& node = nodes_[near.corners[k]];
      swept.start[k] = node.start;
      swept.end[k] = node.end;
      squared = std::max(squared, node.travel_squared);
    }
    if (!swept.complete(near.triangle, nodes, squared)) triangles_.pop_back();
  }
}

/// The nearest node of each cell, of all within reach at the step's end.
/// @returns how many triangles begin at such nodes
std::size_t NearSurface::find_places(const OrganStep& step, const Core& core,
                                     const Wanted& wanted) {
  places_.fill({std::numeric_limits<double>::infinity(), 0});
  const Vec3 a = step.motion.to_world_at_end(core.a);
  const Vec3 along = step.motion.to_world_at_end(core.b) - a;
  const double per_length = core.is_point() ? 0 : 1 / along.squaredNorm();
  const Vec3 lower = a.cwiseMin(a + along) - Vec3::Constant(wanted.reach);
  const Vec3 per_size = kCells / (along.cwiseAbs() + Vec3::Constant(2 * wanted.reach)).array();
  std::size_t count = 0;
  for (const std::uint32_t block : blocks_) {
    within_.clear();
    for (const std::uint32_t node : step.organ.blocks().nodes_of(block)) {
      const Vec3 x = step.organ.positions()[node], from_a = x - a;
      const double at = std::clamp(per_length * from_a.dot(along), 0.0, 1.0);
      const double squared = (from_a - at * along).squaredNorm();
      within_.push_back(squared <= wanted.reach_squared);
      if (!within_.back()) continue;
      const Vec3 cell = (x - lower).cwiseProduct(per_size);
      std::size_t place = 0;
      for (const double along_axis : cell) {
        place = kCells * place + std::min(static_cast<std::size_t>(along_axis), kCells - 1);
      }
      Place& nearest = places_[place];
      if (std::pair(squared, node) < std::pair(nearest.squared, nearest.node)) {
        nearest = {squared, node};
      }
    }
    for (const auto& corners : step.organ.blocks().corners_of(block)) count += within_[corners[0]];
  }
  return count;
}

void NearSurface::gather_front(const OrganStep& step, const Core& core, double reach) {
  const Bounds hull{core.a.cwiseMin(core.b), core.a.cwiseMax(core.b)};
  const Wanted wanted(step.motion, hull, core.radius + reach);
  find_blocks(step, wanted);
  std::size_t most = 0;  // of the triangles within reach: few enough need not be counted
  for (const std::uint32_t block : blocks_) most += step.organ.blocks().corners_of(block).size();
  if (most <= kManyTriangles || find_places(step, core, wanted) <= kManyTriangles) {
    return gather_from_blocks(step, wanted);
  }
  const Wanted touching(step.motion, hull, core.radius);
  const auto &starts = step.organ.boxes_at(step.start_version), &ends = step.organ.boxes();
  std::erase_if(blocks_, [&](std::uint32_t block) {
    return !touching.may_hold(step.motion, starts[block], ends[block]);
  });
  gather_from_blocks(step, touching);
  const auto nearest = std::ranges::min_element(places_, {}, &Place::squared);
  at_places_.clear();
  for (const Place& place : places_) {
    if (!(place.squared <= wanted.reach_squared)) continue;
    const auto around = step.organ.triangles_of_node(place.node);
    const std::size_t of_nearest = &place == &*nearest ? around.size() : 1;
    at_places_.insert(at_places_.end(), around.begin(),
                      around.begin() + static_cast<std::ptrdiff_t>(of_nearest));
  }
  add(step, at_places_);
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

void NearSurface::append_nodes(std::vector<std::uint32_t>& nodes) const {
  for (const SweptTriangle& t : triangles_) {
    nodes.insert(nodes.end(), t.nodes.begin(), t.nodes.end());
  }
  sort_unique(nodes);
}

double NearSurface::travel() const {
  double travel = 0;
  for (const SweptTriangle& t : triangles_) travel = std::max(travel, t.travel);
  return travel;
}

}  // namespace palpate::collision
