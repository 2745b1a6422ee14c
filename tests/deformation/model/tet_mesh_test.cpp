#include "deformation/model/tet_mesh.h"

#include <catch2/catch.hpp>

namespace palpate::deformation {
namespace {

TEST_CASE("tet mesh: counts tetrahedra that are turned inside out") {
  // Oracle: the sign of one tetrahedron's volume.
  TetMesh mesh;
  mesh.tetrahedra = {{0, 1, 2, 3}, {0, 1, 2, 4}};
  std::vector<Vec3> nodes = {Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ(),
                             Vec3(0, 0, 2)};
  CHECK(inverted_tetrahedra(mesh, nodes) == 0);
  nodes[4].z() = -2;
  CHECK(inverted_tetrahedra(mesh, nodes) == 1);
  nodes[3].z() = 0;
  CHECK(inverted_tetrahedra(mesh, nodes) == 2);
}

}  // namespace
}  // namespace palpate::deformation
