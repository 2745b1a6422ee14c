#include "deformation/contact/inner_cores.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <variant>

#include "modules/geometry/bounding_box.h"
#include "modules/geometry/closest_points.h"
#include "modules/geometry/winding_number.h"

namespace palpate::deformation {
namespace {

using geometry::RoundedSegment;

/// From a sharp place to the core [m]: much more than contacts are off by.
constexpr double kInset = 1e-3;
/// Of the least extent, at most.
constexpr double kMostOfExtent = 0.1;

/// Of a mesh, lines lie between so many places, each and so many next to it.
constexpr std::size_t kMostPlaces = 48, kNeighbours = 4;

std::vector<RoundedSegment> axis_of(const scene::ConeShape& cone) {
  const double inset = std::min(kInset, kMostOfExtent * cone.length);
  const double radius = inset * cone.radius / std::hypot(cone.radius, cone.length);
  return {{{0, 0, inset}, {0, 0, cone.length - inset}, radius}};
}

std::vector<RoundedSegment> lines_of(const scene::BoxShape& box) {
  const double inset = std::min(kInset, kMostOfExtent * box.size.minCoeff());
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
  explicit Inside(const geometry::TriangleSurface& surface)
      : surface_(surface),
        inset_(std::min(
            kInset, kMostOfExtent * geometry::bounding_box(surface.nodes).sizes().minCoeff())) {}

  std::vector<RoundedSegment> lines() const {
    const std::vector<Vec3> places = spread_places();
    std::vector<RoundedSegment> lines;
    for (std::size_t i = 0; i < places.size(); ++i) {
      for (const std::size_t k : nearest_to(i, places)) {
        const auto back = nearest_to(k, places);
        const bool again = k < i && std::ranges::find(back, i) != back.end();
        if (!again && distance(places[i], places[k]) >= inset_ / 2)
          lines.push_back({places[i], places[k], inset_ / 2});
      }
    }
    return lines;
  }

 private:
  /// From the surface.
  double distance(const Vec3& a, const Vec3& b) const {
    double least = std::numeric_limits<double>::infinity();
    for (const auto& [i, j, k] : surface_.triangles) {
      const geometry::TriangleCorners corners{surface_.nodes[i], surface_.nodes[j],
                                              surface_.nodes[k]};
      least = std::min(least,
                       a == b ? (geometry::closest_on_triangle(a, corners).point - a).norm()
                              : geometry::closest_of_segment_and_triangle(a, b, corners).distance);
    }
    return least;
  }

  /// Under the node, as far within as a line needs, or further where it is sharp.
  std::optional<Vec3> under(std::size_t node, const Vec3& outward) const {
    for (const double times : {1.0, 1.2, 1.5, 2.0, 3.0, 5.0, 8.0}) {
      const Vec3 place = surface_.nodes[node] - times * inset_ * outward;
      if (geometry::winding_number(place, surface_.nodes, surface_.triangles) > 0.5 &&
          distance(place, place) >= inset_)
        return place;
    }
    return {};
  }

  /// Always that next which is furthest from those before.
  std::vector<Vec3> spread_places() const {
    std::vector<Vec3> outward(surface_.nodes.size(), Vec3::Zero());
    for (const geometry::Triangle& triangle : surface_.triangles) {
      const Vec3 area = geometry::area_vector(surface_.nodes, triangle);
      for (const std::uint32_t node : triangle) outward[node] += area;
    }
    std::vector<double> apart(surface_.nodes.size(), std::numeric_limits<double>::infinity());
    std::vector<Vec3> places;
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

  static std::vector<std::size_t> nearest_to(std::size_t place, const std::vector<Vec3>& places) {
    std::vector<std::size_t> others;
    for (std::size_t i = 0; i < places.size(); ++i) {
      if (i != place) others.push_back(i);
    }
    std::ranges::sort(others, {}, [&](std::size_t i) {
      return std::pair((places[i] - places[place]).norm(), i);
    });
    others.resize(std::min(others.size(), kNeighbours));
    return others;
  }

  const geometry::TriangleSurface& surface_;
  double inset_;
};

struct InnerCores {
  const geometry::TriangleSurface& mesh;
  std::vector<RoundedSegment> operator()(const scene::ConeShape& cone) const {
    return axis_of(cone);
  }
  std::vector<RoundedSegment> operator()(const scene::BoxShape& box) const { return lines_of(box); }
  std::vector<RoundedSegment> operator()(const scene::GrasperShape& jaws) const {
    const auto form = scene::form_of(jaws);
    return Inside(std::get<geometry::TriangleSurface>(form)).lines();
  }
  std::vector<RoundedSegment> operator()(const scene::MeshShape&) const {
    return mesh.triangles.empty() ? std::vector<RoundedSegment>() : Inside(mesh).lines();
  }
  template <class Other>
  std::vector<RoundedSegment> operator()(const Other&) const {
    return {};
  }
};

}  // namespace

std::vector<RoundedSegment> inner_cores(const scene::ProbeShape& shape,
                                        const geometry::TriangleSurface& mesh) {
  return std::visit(InnerCores{mesh}, shape);
}

}  // namespace palpate::deformation
