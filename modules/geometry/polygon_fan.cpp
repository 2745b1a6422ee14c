#include "modules/geometry/polygon_fan.h"

namespace palpate::geometry {
namespace {

/// The search grows with the square of the corners.
constexpr std::size_t kMostCornersSearched = 64;

class PolygonFan {
 public:
  PolygonFan(std::span<const std::uint32_t> corners, const std::vector<Vec3>& nodes)
      : corners_(corners), nodes_(nodes) {}

  std::size_t best_first() const {
    Vec3 area = Vec3::Zero();
    for (std::size_t i = 2; i < corners_.size(); ++i) area += area_of(triangle(0, i));
    for (std::size_t first = 0; first < corners_.size(); ++first) {
      if (!turns_over(first, area)) return first;
    }
    return 0;
  }

  /// i: 2 …
  Triangle triangle(std::size_t first, std::size_t i) const {
    const auto corner = [&](std::size_t k) { return corners_[(first + k) % corners_.size()]; };
    return {corner(0), corner(i - 1), corner(i)};
  }

 private:
  bool turns_over(std::size_t first, const Vec3& area) const {
    for (std::size_t i = 2; i < corners_.size(); ++i) {
      if (area_of(triangle(first, i)).dot(area) < 0) return true;
    }
    return false;
  }

  /// Twice that, with the direction of its normal.
  Vec3 area_of(const Triangle& t) const {
    return (nodes_[t[1]] - nodes_[t[0]]).cross(nodes_[t[2]] - nodes_[t[0]]);
  }

  std::span<const std::uint32_t> corners_;
  const std::vector<Vec3>& nodes_;
};

}  // namespace

void add_fan(std::span<const std::uint32_t> corners, TriangleSurface& surface) {
  const PolygonFan fan(corners, surface.nodes);
  const bool searched = corners.size() > 3 && corners.size() <= kMostCornersSearched;
  const std::size_t first = searched ? fan.best_first() : 0;
  for (std::size_t i = 2; i < corners.size(); ++i) {
    surface.triangles.push_back(fan.triangle(first, i));
  }
}

}  // namespace palpate::geometry
