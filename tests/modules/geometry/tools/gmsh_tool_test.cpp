#include "modules/geometry/tools/gmsh_tool.h"

#include <catch2/catch.hpp>
#include <cstdlib>
#include <fstream>

#include "modules/core/error.h"
#include "modules/geometry/primitives.h"
#include "tests/modules/geometry/scratch.h"
#include "tests/modules/geometry/tetrahedra.h"

namespace palpate::geometry {
namespace {

double volume_of(const TetMesh& mesh) {
  double volume = 0;
  for (const auto& [a, b, c, d] : mesh.tetrahedra) {
    volume += tetrahedron_volume(mesh.nodes[a], mesh.nodes[b], mesh.nodes[c], mesh.nodes[d]);
  }
  return volume;
}

TEST_CASE("gmsh tool: a filled surface keeps its nodes and triangles, first and in order") {
  // Oracle: the surface itself, to the last bit; its enclosed volume.
  if (testing::without_gmsh()) return;
  const auto ball = make_ball(0.05, 2);
  const auto mesh = fill_surface(ball, 0.02);
  REQUIRE(mesh.nodes.size() > ball.nodes.size());
  for (std::size_t i = 0; i < ball.nodes.size(); ++i) CHECK(mesh.nodes[i] == ball.nodes[i]);
  auto sorted = [](Triangle t) {
    std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    return t;
  };
  std::vector<Triangle> wanted, found;
  for (const auto& triangle : ball.triangles) wanted.push_back(sorted(triangle));
  for (const auto& triangle : boundary_triangles(mesh)) found.push_back(sorted(triangle.nodes));
  std::sort(wanted.begin(), wanted.end());
  std::sort(found.begin(), found.end());
  CHECK(found == wanted);
  CHECK(volume_of(mesh) == Approx(enclosed_volume(ball.nodes, ball.triangles)));
}

TEST_CASE("gmsh tool: an octant of a ball lies on its planes and its sphere, a block is a block") {
  // Oracle: geometry. Chords of 15 mm cut 4 % off the octant's π R³/6.
  if (testing::without_gmsh()) return;
  const auto octant = mesh_ball(0.05, BallPart::kOctant, "0.015");
  double farthest = 0;
  for (const Vec3& p : octant.nodes) {
    CHECK(p.minCoeff() >= 0);
    farthest = std::max(farthest, p.norm());
  }
  CHECK(farthest == Approx(0.05).epsilon(1e-12));
  CHECK(volume_of(octant) == Approx(3.14159265 * 0.05 * 0.05 * 0.05 / 6).epsilon(0.05));
  const auto block = mesh_block({0, 0, 0}, {0.04, 0.04, 0.08}, "0.02 + 0*x");
  CHECK(volume_of(block) == Approx(0.04 * 0.04 * 0.08));
}

TEST_CASE("gmsh tool: what it cannot do is said") {
  // Oracle: the stated messages; PATH without gmsh.
  const std::string path = std::getenv("PATH");
  ::setenv("PATH", "/nowhere", 1);
  CHECK_THROWS_WITH(mesh_ball(0.05, BallPart::kWhole, "0.02"), Catch::Contains("gmsh: not found"));
  ::setenv("PATH", path.c_str(), 1);
  if (testing::without_gmsh()) return;
  CHECK_THROWS_AS(run_gmsh("Box(1) = {"), InputError);
  auto open = make_ball(0.05, 1);
  open.triangles.pop_back();
  CHECK_THROWS_AS(fill_surface(open, 0.02), InputError);
}

TEST_CASE("gmsh tool: what would need far too many nodes is refused at once") {
  // Oracle: the message; a ball of 0.52 l holds some 7e8 nodes 0.1 mm apart.
  CHECK_THROWS_WITH(fill_surface(make_ball(0.05, 3), 1e-4), Catch::Contains("choose 0.0015 m"));
}

TEST_CASE("gmsh tool: a file without tetrahedra is refused by its own name") {
  // Oracle: the message. One triangle, as VTK's legacy format has it.
  if (testing::without_gmsh()) return;
  const test::ScratchFolder folder;
  const auto file = folder / "shell.vtk";
  std::ofstream(file) << "# vtk DataFile Version 2.0\nshell\nASCII\nDATASET UNSTRUCTURED_GRID\n"
                         "POINTS 3 double\n0 0 0\n1 0 0\n0 1 0\n"
                         "CELLS 1 4\n3 0 1 2\nCELL_TYPES 1\n5\n";
  CHECK_THROWS_WITH(read_tetrahedra(file), file.string() + ": no tetrahedra");
}

}  // namespace
}  // namespace palpate::geometry
