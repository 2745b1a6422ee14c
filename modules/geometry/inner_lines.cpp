#include "modules/geometry/inner_lines.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <variant>

#include "modules/geometry/bounding_box.h"
#include "modules/geometry/closest_points.h"
#include "modules/geometry/winding_number.h"

namespace palpate::geometry {
namespace {

/// Of a mesh, lines lie between so many places, each and so many next to it.
constexpr std::size_t kMostPlaces = 48, kNeighbours = 4;

std::vector<RoundedSegment> lines_of(const Box& box) {
  const double inset = inner_inset(box.size.minCoeff());
  const Vec3 half = box.size / 2 - Vec3::Constant(inset);
  std::vector<RoundedSegment> lines;
  for (int axis = 0; axis < 3; ++axis) {
    for (const int s : {-1, 0, 1}) {
      for (const int t : {-1, 0, 1}) {
        if (s == 0 && t == 0) continue;
        Vec3 end = half;
        end[(axis + 1) % 3] *= s;
        end[(axis + 2) % 3] *= t;
        Vec3 other = end;
        other[axis] = -end[axis];
        lines.push_back({other, end, inset});
      }
    }
  }
  return lines;
}

/// Of a closed surface.
class Inside {
 public:
  explicit Inside(const TriangleSurface& surface)
      : surface_(surface), inset_(inner_inset(bounding_box(surface.nodes).sizes().minCoeff())) {}

  std::vector<RoundedSegment> lines() const {
    const std::vector<Place> places = spread_places();
    std::vector<RoundedSegment> lines;
    for (std::size_t i = 0; i < places.size(); ++i) {
      for (const std::size_t k : nearest_to(i, places)) {
        const auto back = nearest_to(k, places);
        const bool again = k < i && std::ranges::find(back, i) != back.end();
        const double radius = std::min(places[i].clear, places[k].clear) / 2;
        if (!again && distance(places[i].at, places[k].at) >= radius)
          lines.push_back({places[i].at, places[k].at, radius});
      }
    }
    return lines;
  }

 private:
  struct Place {
    Vec3 at;
    double clear = 0;  ///< from the surface at least [m]
  };

  /// From the surface.
  double distance(const Vec3& a, const Vec3& b) const {
    double least = std::numeric_limits<double>::infinity();
    for (const auto& [i, j, k] : surface_.triangles) {
      const TriangleCorners corners{surface_.nodes[i], surface_.nodes[j], surface_.nodes[k]};
      least = std::min(least, a == b ? (closest_on_triangle(a, corners).point - a).norm()
                                     : closest_of_segment_and_triangle(a, b, corners).distance);
    }
    return least;
  }

  /// Under the node, as far within as a line needs, or further where it is sharp; in a tip so far
  /// as there is some room.
  std::optional<Place> under(std::size_t node, const Vec3& outward) const {
    const auto place = [&](double times, double clear) -> std::optional<Place> {
      const Vec3 at = surface_.nodes[node] - times * inset_ * outward;
      const bool is_inside = winding_number(at, surface_.nodes, surface_.triangles) > 0.5;
      if (is_inside && distance(at, at) >= clear) return Place{at, clear};
      return {};
    };
    for (const double times : {1.0, 1.2, 1.5, 2.0, 3.0, 5.0, 8.0}) {
      if (const auto found = place(times, inset_)) return found;
    }
    return place(3, inset_ / 8);
  }

  /// Always that next which is furthest from those before.
  std::vector<Place> spread_places() const {
    std::vector<Vec3> outward(surface_.nodes.size(), Vec3::Zero());
    for (const Triangle& triangle : surface_.triangles) {
      const Vec3 area = area_vector(surface_.nodes, triangle);
      for (const std::uint32_t node : triangle) outward[node] += area;
    }
    std::vector<double> apart(surface_.nodes.size(), std::numeric_limits<double>::infinity());
    std::vector<Place> places;
    for (std::size_t tries = 0; tries < 2 * kMostPlaces && places.size() < kMostPlaces; ++tries) {
      const auto furthest = std::ranges::max_element(apart);
      if (!(*furthest > 0)) break;
      const auto node = static_cast<std::size_t>(furthest - apart.begin());
      for (std::size_t i = 0; i < apart.size(); ++i) {
        apart[i] = std::min(apart[i], (surface_.nodes[i] - surface_.nodes[node]).norm());
      }
      const auto place = under(node, outward[node].stableNormalized());
      if (place) places.push_back(*place);
    }
    return places;
  }

  static std::vector<std::size_t> nearest_to(std::size_t place, const std::vector<Place>& places) {
    std::vector<std::size_t> others;
    for (std::size_t i = 0; i < places.size(); ++i) {
      if (i != place) others.push_back(i);
    }
    std::ranges::sort(others, {}, [&](std::size_t i) {
      return std::pair((places[i].at - places[place].at).norm(), i);
    });
    others.resize(std::min(others.size(), kNeighbours));
    return others;
  }

  const TriangleSurface& surface_;
  double inset_;
};

struct InnerLines {
  std::vector<RoundedSegment> operator()(const Box& box) const { return lines_of(box); }
  std::vector<RoundedSegment> operator()(const TriangleSurface& surface) const {
    return surface.triangles.empty() ? std::vector<RoundedSegment>() : Inside(surface).lines();
  }
  template <class Other>
  std::vector<RoundedSegment> operator()(const Other&) const {
    return {};
  }
};

}  // namespace

double inner_inset(double least_extent) {
  constexpr double kInset = 1e-3;  // [m], much more than contacts are off by
  constexpr double kMostOfExtent = 0.1;
  return std::min(kInset, kMostOfExtent * least_extent);
}

std::vector<RoundedSegment> inner_lines(const ProbeForm& form) {
  return std::visit(InnerLines{}, form);
}

}  // namespace palpate::geometry
