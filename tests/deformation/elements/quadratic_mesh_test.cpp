#include "deformation/elements/quadratic_mesh.h"

#include <algorithm>
#include <catch2/catch.hpp>

#include "modules/geometry/organ_shape.h"
#include "solids.h"

namespace palpate::deformation {
namespace {

TEST_CASE("quadratic mesh: every edge has one node in its middle, on faces too") {
  // Oracle: the definition, element by element; corners + edges of a 1-cube Kuhn block: 8 + 19.
  const auto mesh = make_quadratic(testing::block(Vec3::Ones(), 1, 1, 1));
  CHECK(mesh.corner_count == 8);
  CHECK(mesh.nodes.size() == 8 + 19);
  for (const auto& element : mesh.elements) {
    for (int e = 0; e < 6; ++e) {
      const auto& [a, b] = kTetrahedronEdges[e];
      const Vec3 middle = (mesh.nodes[element[a]] + mesh.nodes[element[b]]) / 2;
      CHECK((mesh.nodes[element[4 + e]] - middle).norm() == 0);
    }
  }
  REQUIRE(mesh.faces.size() == 12);
  for (const auto& face : mesh.faces) {
    for (int k = 0; k < 3; ++k) {
      const Vec3 middle =
          (mesh.nodes[mesh.face_node(face, k)] + mesh.nodes[mesh.face_node(face, (k + 1) % 3)]) / 2;
      CHECK((mesh.nodes[mesh.face_node(face, 3 + k)] - middle).norm() == 0);
    }
  }
}

TEST_CASE("quadratic mesh: nodes may come in any order") {
  // Oracle: the same solid numbered corners first. Corners are numbered without a gap, and every
  // element has the same nodes in the same places.
  const auto shape =
      geometry::with_edge_nodes(geometry::shape_of(testing::block(Vec3::Ones(), 2, 2, 2)));
  std::vector<Vec3> nodes;
  for (std::size_t i = 0; i < shape.node_count(); ++i) nodes.push_back(shape.node(i));
  const auto mesh = make_quadratic(nodes, shape.tetrahedra, shape.edge_nodes);
  const auto ordered = make_quadratic(testing::block(Vec3::Ones(), 2, 2, 2));
  CHECK(mesh.corner_count == ordered.corner_count);
  REQUIRE(mesh.elements.size() == ordered.elements.size());
  std::vector<int> used(mesh.corner_count, 0);
  for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
    for (std::size_t a = 0; a < kElementNodes; ++a) {
      CHECK(mesh.nodes[mesh.elements[e][a]] == ordered.nodes[ordered.elements[e][a]]);
    }
    for (const auto corner : mesh.corners[e]) used.at(corner) = 1;
  }
  CHECK(std::count(used.begin(), used.end(), 1) == 27);
}

TEST_CASE("quadratic mesh: curving moves edge nodes of faces on the sphere only") {
  // Oracle: a tetrahedron with one face on the unit sphere, worked by hand.
  geometry::TetMesh corner{{Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()},
                           {{0, 1, 2, 3}}};
  auto mesh = make_quadratic(corner);
  const auto straight = mesh.nodes;
  curve_onto_sphere(mesh, Vec3::Zero(), 1);
  std::size_t moved = 0;
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    if (mesh.nodes[i] == straight[i]) continue;
    ++moved;
    CHECK(mesh.nodes[i].norm() == Approx(1));
    CHECK(straight[i].norm() == Approx(std::sqrt(0.5)));
  }
  CHECK(moved == 3);
}

}  // namespace
}  // namespace palpate::deformation
