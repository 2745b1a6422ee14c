#include "modules/geometry/surface_transfer.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <utility>

#include "modules/geometry/closest_points.h"

namespace palpate::geometry {
namespace {

/// Numbers of places by the places, in one row with gaps.
class PlaceTable {
 public:
  explicit PlaceTable(std::span<const Vec3> places)
      : places_(places), numbers_(std::bit_ceil(2 * places.size() + 1), kNoPlace) {
    for (std::uint32_t i = 0; i < places.size(); ++i) {
      std::uint32_t& number = numbers_[slot_of(places[i])];
      if (number == kNoPlace) number = i;
    }
  }
  /// Of the first that is equal; kNoPlace: none.
  std::uint32_t number_of(const Vec3& place) const { return numbers_[slot_of(place)]; }

 private:
  static std::size_t hash(const Vec3& x) {
    std::uint64_t hash = 0;
    for (int k = 0; k < 3; ++k) {
      // Sums with 0 make −0 and 0, which are equal, alike.
      hash = (hash ^ std::bit_cast<std::uint64_t>(x[k] + 0.0)) * 0x9E3779B97F4A7C15u;
      hash ^= hash >> 32;
    }
    return hash;
  }
  std::size_t slot_of(const Vec3& place) const {
    const std::size_t last = numbers_.size() - 1;
    std::size_t slot = hash(place) & last;
    while (numbers_[slot] != kNoPlace && places_[numbers_[slot]] != place) slot = (slot + 1) & last;
    return slot;
  }

  std::span<const Vec3> places_;
  std::vector<std::uint32_t> numbers_;
};

/// Triangles by their corners.
class CornerTable {
 public:
  CornerTable(std::span<const Triangle> triangles, std::size_t node_count)
      : begins_(node_count + 1, 0), entries_(triangles.size()) {
    for (const Triangle& t : triangles) ++begins_[std::ranges::min(t) + 1];
    std::partial_sum(begins_.begin(), begins_.end(), begins_.begin());
    std::vector<std::uint32_t> next = begins_;
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
      const Triangle corners = sorted(triangles[t]);
      entries_[next[corners[0]]++] = {corners, t};
    }
  }
  /// Of the first with these corners in any order; kNoPlace: none, or one is kNoPlace.
  std::uint32_t number_of(const Triangle& corners) const {
    const Triangle wanted = sorted(corners);
    if (wanted[2] == kNoPlace) return kNoPlace;
    for (std::uint32_t i = begins_[wanted[0]]; i < begins_[wanted[0] + 1]; ++i) {
      if (entries_[i].first == wanted) return entries_[i].second;
    }
    return kNoPlace;
  }

 private:
  static Triangle sorted(Triangle t) {
    std::ranges::sort(t);
    return t;
  }

  std::vector<std::uint32_t> begins_;  ///< of each lowest corner, in entries_
  std::vector<std::pair<Triangle, std::uint32_t>> entries_;
};

TriangleCorners corners_of(const Triangle& t, const std::vector<Vec3>& nodes) {
  return {nodes[t[0]], nodes[t[1]], nodes[t[2]]};
}

}  // namespace

std::vector<std::uint32_t> same_places(std::span<const Vec3> from, std::span<const Vec3> to) {
  const PlaceTable table(to);
  std::vector<std::uint32_t> same;
  same.reserve(from.size());
  for (const Vec3& place : from) same.push_back(table.number_of(place));
  return same;
}

SurfaceTransfer::SurfaceTransfer(std::span<const Vec3> from_rest, std::span<const Triangle> from,
                                 std::span<const Vec3> to_rest, std::span<const Triangle> to)
    : from_rest_(from_rest.begin(), from_rest.end()),
      to_rest_(to_rest.begin(), to_rest.end()),
      from_(from.begin(), from.end()),
      to_(to.begin(), to.end()),
      nodes_(same_places(from_rest, to_rest)),
      triangles_(from.size(), kNoPlace) {
  const CornerTable table(to, to_rest.size());
  std::vector<bool> known(to.size(), false);
  for (std::size_t t = 0; t < from.size(); ++t) {
    Triangle same{};
    for (std::size_t k = 0; k < 3; ++k) same[k] = nodes_[from[t][k]];
    triangles_[t] = table.number_of(same);
    if (triangles_[t] != kNoPlace) known[triangles_[t]] = true;
  }
  // Surfaces that do not divide the same faces find something, too.
  if (std::ranges::find(known, false) == known.end()) known.assign(to.size(), false);
  for (std::uint32_t t = 0; t < to.size(); ++t) {
    if (known[t]) continue;
    New added{t, Vec3::Zero(), 0};
    for (const auto node : to[t]) added.centre += to_rest[node] / 3;
    for (const auto node : to[t]) {
      added.radius = std::max(added.radius, (to_rest[node] - added.centre).norm());
    }
    new_.push_back(added);
  }
}

PlaceOnSurface SurfaceTransfer::place(const PlaceOnSurface& of_from) const {
  const Triangle& corners = from_[of_from.triangle];
  if (triangles_[of_from.triangle] != kNoPlace) {
    PlaceOnSurface same{triangles_[of_from.triangle], Vec3::Zero()};
    const Triangle& to = to_[same.triangle];
    for (std::size_t k = 0; k < 3; ++k) {
      const auto at = std::ranges::find(to, nodes_[corners[k]]) - to.begin();
      same.weights[at] = of_from.weights[static_cast<Eigen::Index>(k)];
    }
    return same;
  }
  Vec3 x = Vec3::Zero();
  for (std::size_t k = 0; k < 3; ++k) {
    x += of_from.weights[static_cast<Eigen::Index>(k)] * from_rest_[corners[k]];
  }
  PlaceOnSurface nearest;
  double least = std::numeric_limits<double>::infinity();
  for (const New& candidate : new_) {
    if ((x - candidate.centre).norm() - candidate.radius >= least) continue;
    const PointOnTriangle at =
        closest_on_triangle(x, corners_of(to_[candidate.triangle], to_rest_));
    const double distance = (x - at.point).norm();
    if (distance >= least) continue;
    least = distance;
    nearest = {candidate.triangle, at.weights};
  }
  return nearest;
}

}  // namespace palpate::geometry
