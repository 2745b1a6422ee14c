#include "modules/geometry/organ_shape.h"

#include <catch2/catch.hpp>
#include <cstdlib>

#include "modules/core/error.h"
#include "modules/geometry/tools/gmsh_tool.h"
#include "tests/modules/geometry/tetrahedra.h"

namespace palpate::geometry {
namespace {

double tetrahedra_volume(const OrganShape& shape) {
  return testing::volume_of(shape.tetrahedra, [&](std::uint32_t i) { return shape.node(i); });
}

TEST_CASE("organ shape: boundary nodes come first and the surface encloses the tetrahedra") {
  // Oracle: geometry of a block of 3 × 3 × 3 cubes: 8 nodes inside, 108 triangles, its volume.
  const auto shape = shape_of(testing::block({0.1, 0.2, 0.3}, 3, 3, 3));
  CHECK(shape.is_solid());
  CHECK(shape.inner_nodes.size() == 8);
  CHECK(shape.surface.nodes.size() == 64 - 8);
  CHECK(shape.surface.triangles.size() == 108);
  CHECK(tetrahedra_volume(shape) == Approx(0.006));
  CHECK(enclosed_volume(shape.surface.nodes, shape.surface.triangles) == Approx(0.006));
}

TEST_CASE("organ shape: edge nodes lie in the middle and quarter the surface") {
  // Oracle: positions; Euler's formula for the surface; the same volume.
  const auto linear = shape_of(testing::block({0.1, 0.2, 0.3}, 2, 2, 2));
  const auto shape = with_edge_nodes(linear);
  REQUIRE(shape.edge_nodes.size() == shape.tetrahedra.size());
  CHECK(tetrahedra_volume(shape) == Approx(0.006));
  for (std::size_t t = 0; t < shape.tetrahedra.size(); ++t) {
    for (std::size_t e = 0; e < 6; ++e) {
      const auto& [a, b] = kTetrahedronEdges[e];
      const Vec3 middle =
          (shape.node(shape.tetrahedra[t][a]) + shape.node(shape.tetrahedra[t][b])) / 2;
      CHECK(shape.node(shape.edge_nodes[t][e]) == middle);
    }
  }
  CHECK(shape.surface.triangles.size() == 4 * linear.surface.triangles.size());
  CHECK(shape.surface.triangles.size() == 2 * shape.surface.nodes.size() - 4);
  CHECK(enclosed_volume(shape.surface.nodes, shape.surface.triangles) == Approx(0.006));
  for (std::size_t i = 0; i < linear.surface.nodes.size(); ++i) {
    CHECK(shape.surface.nodes[i] == linear.surface.nodes[i]);
  }
}

TEST_CASE("organ shape: tetrahedra that only share an edge hold no volume together") {
  // Oracle: four triangles meet in that edge.
  const TetMesh mesh{
      {Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ(), {1, -1, -1}, {0, -1, -1}},
      {{0, 1, 2, 3}, {0, 1, 5, 4}}};
  CHECK_THROWS_WITH(shape_of(mesh), Catch::Contains("cannot hold a volume"));
}

TEST_CASE("organ shape: tetrahedra of other formats are read through Gmsh") {
  // Oracle: the counts and sizes stated with the data (gallbladder 366 nodes, 1,063 tetrahedra;
  // liver 507, counted in the file, 1,493).
  if (testing::without_gmsh()) return;
  const char* folder = std::getenv("PALPATE_DATA");
  const std::filesystem::path data =
      folder != nullptr ? folder : std::filesystem::path(PALPATE_SOURCE_DIR) / "../shared/data";
  if (!std::filesystem::exists(data / "organs/gallbladder_tets.vtk")) {
    std::printf("SKIPPED: no organs in PALPATE_DATA\n");
    return;
  }
  const auto gallbladder = shape_of(read_tetrahedra(data / "organs/gallbladder_tets.vtk"));
  CHECK(gallbladder.node_count() == 366);
  CHECK(gallbladder.tetrahedra.size() == 1063);
  const auto liver = shape_of(read_tetrahedra(data / "organs/sofa_liver2_tets.msh"));
  CHECK(liver.node_count() == 507);
  CHECK(liver.tetrahedra.size() == 1493);
  CHECK_THROWS_WITH(read_tetrahedra(data / "hard-meshes/sofa_6_tetra_bad.msh"),
                    Catch::Contains("sofa_6_tetra_bad.msh"));
  CHECK_THROWS_AS(read_tetrahedra("/nowhere.msh"), InputError);
}

}  // namespace
}  // namespace palpate::geometry
