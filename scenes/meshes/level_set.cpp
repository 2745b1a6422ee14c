#include "scenes/meshes/level_set.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "modules/geometry/orientation.h"

namespace palpate::meshes {
namespace {

using geometry::TriangleSurface;

// Keeps nodes away from grid corners, where triangles would have no area.
constexpr double kLeastFraction = 0.05;

// Corners of a cube are numbered by bits x = 1, y = 2, z = 4; all six tetrahedra share 0–7.
constexpr std::array<std::array<int, 4>, 6> kTetrahedra{
    {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}}};

class Marcher {
 public:
  Marcher(const Shape& shape, const Eigen::AlignedBox3d& box, double cell)
      : origin_(box.min()), cell_(cell) {
    for (int axis = 0; axis < 3; ++axis) {
      count_[axis] = static_cast<std::uint32_t>(std::ceil(box.sizes()[axis] / cell)) + 1;
    }
    values_.reserve(std::size_t{count_[0]} * count_[1] * count_[2]);
    for (std::uint32_t k = 0; k < count_[2]; ++k) {
      for (std::uint32_t j = 0; j < count_[1]; ++j) {
        for (std::uint32_t i = 0; i < count_[0]; ++i) values_.push_back(shape(place(i, j, k)));
      }
    }
  }

  TriangleSurface march() {
    for (std::uint32_t k = 0; k + 1 < count_[2]; ++k) {
      for (std::uint32_t j = 0; j + 1 < count_[1]; ++j) {
        for (std::uint32_t i = 0; i + 1 < count_[0]; ++i) march_cube(i, j, k);
      }
    }
    geometry::orient_outward(surface_);
    return std::move(surface_);
  }

 private:
  Vec3 place(std::uint32_t i, std::uint32_t j, std::uint32_t k) const {
    return origin_ + cell_ * Vec3(i, j, k);
  }
  std::uint32_t index(std::uint32_t i, std::uint32_t j, std::uint32_t k) const {
    return i + count_[0] * (j + count_[1] * k);
  }
  Vec3 place(std::uint32_t index) const {
    return place(index % count_[0], index / count_[0] % count_[1], index / count_[0] / count_[1]);
  }

  void march_cube(std::uint32_t i, std::uint32_t j, std::uint32_t k) {
    std::array<std::uint32_t, 8> corners{};
    int inside = 0;
    for (std::uint32_t c = 0; c < 8; ++c) {
      corners[c] = index(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2));
      inside += values_[corners[c]] < 0;
    }
    if (inside == 0 || inside == 8) return;
    for (const auto& [a, b, c, d] : kTetrahedra) {
      march_tetrahedron({corners[a], corners[b], corners[c], corners[d]});
    }
  }

  void march_tetrahedron(std::array<std::uint32_t, 4> corners) {
    const auto outside = std::partition(corners.begin(), corners.end(),
                                        [&](std::uint32_t c) { return values_[c] < 0; });
    const auto inside = outside - corners.begin();
    const auto [a, b, c, d] = corners;
    if (inside == 1) add(cut(a, b), cut(a, c), cut(a, d));
    if (inside == 3) add(cut(d, a), cut(d, b), cut(d, c));
    if (inside == 2) {
      add(cut(a, c), cut(a, d), cut(b, d));
      add(cut(a, c), cut(b, d), cut(b, c));
    }
  }

  /// The node where the surface cuts the grid edge (p, q).
  std::uint32_t cut(std::uint32_t p, std::uint32_t q) {
    const auto [low, high] = std::minmax(p, q);
    const auto next = static_cast<std::uint32_t>(surface_.nodes.size());
    const auto [entry, is_new] = cuts_.try_emplace({low, high}, next);
    if (is_new) {
      const double fraction = std::clamp(values_[low] / (values_[low] - values_[high]),
                                         kLeastFraction, 1 - kLeastFraction);
      surface_.nodes.push_back(place(low) + fraction * (place(high) - place(low)));
    }
    return entry->second;
  }

  void add(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    surface_.triangles.push_back({a, b, c});
  }

  Vec3 origin_;
  double cell_;
  std::array<std::uint32_t, 3> count_{};
  std::vector<double> values_;
  std::map<std::array<std::uint32_t, 2>, std::uint32_t> cuts_;
  TriangleSurface surface_;
};

}  // namespace

TriangleSurface level_set_surface(const Shape& shape, const Eigen::AlignedBox3d& box, double cell) {
  return Marcher(shape, box, cell).march();
}

}  // namespace palpate::meshes
