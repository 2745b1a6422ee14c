#include "modules/geometry/tet_mesh.h"

#include <algorithm>

namespace palpate::geometry {

double tetrahedron_volume(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return (b - a).cross(c - a).dot(d - a) / 6;
}

std::vector<BoundaryTriangle> boundary_triangles(const TetMesh& mesh) {
  std::vector<BoundaryTriangle> all;
  std::vector<std::pair<Triangle, std::size_t>> by_corners;
  all.reserve(4 * mesh.tetrahedra.size());
  by_corners.reserve(4 * mesh.tetrahedra.size());
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    for (int f = 0; f < 4; ++f) {
      Triangle nodes{};
      for (int k = 0; k < 3; ++k) nodes[k] = mesh.tetrahedra[t][kTetrahedronFaces[f][k]];
      Triangle sorted = nodes;
      std::sort(sorted.begin(), sorted.end());
      by_corners.emplace_back(sorted, all.size());
      all.push_back({nodes, static_cast<std::uint32_t>(t), f});
    }
  }
  std::sort(by_corners.begin(), by_corners.end());
  std::vector<std::size_t> single;
  for (std::size_t i = 0; i < by_corners.size(); ++i) {
    const bool twin_before = i > 0 && by_corners[i - 1].first == by_corners[i].first;
    const bool twin_after =
        i + 1 < by_corners.size() && by_corners[i + 1].first == by_corners[i].first;
    if (!twin_before && !twin_after) single.push_back(by_corners[i].second);
  }
  std::sort(single.begin(), single.end());
  std::vector<BoundaryTriangle> boundary;
  boundary.reserve(single.size());
  for (const std::size_t i : single) boundary.push_back(all[i]);
  return boundary;
}

}  // namespace palpate::geometry
