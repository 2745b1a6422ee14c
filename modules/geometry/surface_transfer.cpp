#include "modules/geometry/surface_transfer.h"

#include <algorithm>
#include <bit>
#include <unordered_map>

#include "modules/geometry/closest_points.h"

namespace palpate::geometry {
namespace {

struct PlaceHash {
  std::size_t operator()(const Vec3& x) const {
    std::uint64_t hash = 0;
    for (int k = 0; k < 3; ++k) {
      // Sums with 0 make −0 and 0, which are equal, alike.
      hash = (hash ^ std::bit_cast<std::uint64_t>(x[k] + 0.0)) * 0x9E3779B97F4A7C15u;
      hash ^= hash >> 32;
    }
    return hash;
  }
};

struct CornersHash {
  std::size_t operator()(const Triangle& t) const {
    return (std::size_t{t[0]} * 0x9E3779B97F4A7C15u ^ t[1]) * 0x9E3779B97F4A7C15u ^ t[2];
  }
};

Triangle sorted(Triangle t) {
  std::ranges::sort(t);
  return t;
}

TriangleCorners corners_of(const Triangle& t, const std::vector<Vec3>& nodes) {
  return {nodes[t[0]], nodes[t[1]], nodes[t[2]]};
}

}  // namespace

std::vector<std::uint32_t> same_places(std::span<const Vec3> from, std::span<const Vec3> to) {
  std::unordered_map<Vec3, std::uint32_t, PlaceHash> places(2 * to.size());
  for (std::uint32_t i = 0; i < to.size(); ++i) places.try_emplace(to[i], i);
  std::vector<std::uint32_t> same;
  same.reserve(from.size());
  for (const Vec3& place : from) {
    const auto found = places.find(place);
    same.push_back(found == places.end() ? kNoPlace : found->second);
  }
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
  std::unordered_map<Triangle, std::uint32_t, CornersHash> corners(2 * to.size());
  for (std::uint32_t t = 0; t < to.size(); ++t) corners.try_emplace(sorted(to[t]), t);
  std::vector<bool> known(to.size(), false);
  for (std::size_t t = 0; t < from.size(); ++t) {
    Triangle same{};
    for (std::size_t k = 0; k < 3; ++k) same[k] = nodes_[from[t][k]];
    const auto found = corners.find(sorted(same));
    if (found == corners.end()) continue;
    triangles_[t] = found->second;
    known[found->second] = true;
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
