#include "deformation/model/tet_mesh.h"

#include <algorithm>

namespace palpate::deformation {

std::size_t inverted_tetrahedra(const TetMesh& mesh, const std::vector<Vec3>& positions) {
  const auto is_inverted = [&](const geometry::Tetrahedron& t) {
    const Vec3 a = positions[t[1]] - positions[t[0]];
    const Vec3 b = positions[t[2]] - positions[t[0]];
    const Vec3 c = positions[t[3]] - positions[t[0]];
    return !(a.dot(b.cross(c)) > 0);
  };
  return static_cast<std::size_t>(
      std::count_if(mesh.tetrahedra.begin(), mesh.tetrahedra.end(), is_inverted));
}

}  // namespace palpate::deformation
