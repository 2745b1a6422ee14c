#include "studies/truth/wall_mesh.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <set>
#include <utility>
#include <vector>

#include "modules/core/error.h"

namespace palpate::truth {
namespace {

/// Where the inner node of each goes: by a length on which the wall is, in the mean of the
/// triangles around, as thick as wanted.
std::vector<Vec3> inward_steps(const geometry::TriangleSurface& outer, double thickness) {
  std::vector<Vec3> normals(outer.nodes.size(), Vec3::Zero());
  std::vector<double> areas(outer.nodes.size(), 0);
  for (const auto& [a, b, c] : outer.triangles) {
    const Vec3 normal =
        (outer.nodes[b] - outer.nodes[a]).cross(outer.nodes[c] - outer.nodes[a]) / 2;
    for (const auto node : {a, b, c}) {
      normals[node] += normal;
      areas[node] += normal.norm();
    }
  }
  // |Σ A n| / Σ A is the mean cosine between the triangles' normals and their mean.
  for (std::size_t i = 0; i < normals.size(); ++i) {
    normals[i] *= -thickness * areas[i] / normals[i].squaredNorm();
  }
  return normals;
}

/// Each side of a prism is cut from its outer node of lower number, so that neighbours agree.
std::array<geometry::Tetrahedron, 3> divided_prism(geometry::Triangle top, std::uint32_t below) {
  bool is_even = true;
  for (const auto& [i, j] : {std::pair(0, 1), std::pair(1, 2), std::pair(0, 1)}) {
    if (top[i] < top[j]) continue;
    std::swap(top[i], top[j]);
    is_even = !is_even;
  }
  const auto& [a, b, c] = top;
  std::array<geometry::Tetrahedron, 3> parts{
      {{a, b, c, c + below}, {a, b, c + below, b + below}, {a, b + below, c + below, a + below}}};
  if (is_even) {
    for (auto& part : parts) std::swap(part[0], part[1]);
  }
  return parts;
}

/// Outer nodes of prisms of which a part has less than a tenth of the volume it would have in a
/// flat wall.
std::set<std::uint32_t> folded_nodes(const geometry::TriangleSurface& outer,
                                     const geometry::TetMesh& wall, double thickness,
                                     const std::vector<double>& parts) {
  constexpr double kLeastVolume = 0.1;
  const auto& nodes = wall.nodes;
  std::set<std::uint32_t> folded;
  for (std::size_t t = 0; t < outer.triangles.size(); ++t) {
    const auto& [i, j, k] = outer.triangles[t];
    const double area = (nodes[j] - nodes[i]).cross(nodes[k] - nodes[i]).norm() / 2;
    const double flat = area * thickness * std::min({parts[i], parts[j], parts[k]}) / 3;
    for (std::size_t part = 3 * t; part < 3 * t + 3; ++part) {
      const auto& [a, b, c, d] = wall.tetrahedra[part];
      const double volume = geometry::tetrahedron_volume(nodes[a], nodes[b], nodes[c], nodes[d]);
      if (volume < kLeastVolume * flat) folded.insert({i, j, k});
    }
  }
  return folded;
}

}  // namespace

WallMesh wall_under(const geometry::TriangleSurface& outer, double thickness) {
  constexpr double kThinner = 0.7, kLeastPart = 0.1;
  const std::size_t count = outer.nodes.size();
  const auto steps = inward_steps(outer, thickness);
  std::vector<double> parts(count, 1);  // of the steps
  WallMesh wall;
  for (const auto& triangle : outer.triangles) {
    const auto prism = divided_prism(triangle, static_cast<std::uint32_t>(count));
    wall.mesh.tetrahedra.insert(wall.mesh.tetrahedra.end(), prism.begin(), prism.end());
  }
  for (bool is_sound = false; !is_sound;) {
    wall.mesh.nodes = outer.nodes;
    for (std::size_t i = 0; i < count; ++i) {
      wall.mesh.nodes.push_back(outer.nodes[i] + parts[i] * steps[i]);
    }
    const auto folded = folded_nodes(outer, wall.mesh, thickness, parts);
    is_sound = folded.empty();
    for (const auto node : folded) {
      parts[node] *= kThinner;
      if (parts[node] >= kLeastPart) continue;
      const Vec3& at = outer.nodes[node];
      throw InputError(fmt::format(
          "a wall of {:g} m does not fit under the surface near ({:.3f}, {:.3f}, {:.3f}) m; choose "
          "a thinner wall, or smooth the surface there",
          thickness, at.x(), at.y(), at.z()));
    }
  }
  wall.thinned =
      static_cast<std::size_t>(std::ranges::count_if(parts, [](double part) { return part < 1; }));
  return wall;
}

}  // namespace palpate::truth
