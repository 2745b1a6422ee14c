// Meshes nobody on this project made: what users really hand over.
#include <cstdlib>
#include <iostream>
#include <optional>

#include "modules/core/error.h"
#include "modules/geometry/mesh_io.h"
#include "modules/geometry/mesh_prepare.h"
#include "tests/modules/geometry/scratch.h"

using namespace palpate;
using namespace palpate::geometry;
using namespace palpate::geometry::test;
using Catch::Contains;

namespace {

/// The file in the data folder; none (and a visible line) where the folder is absent.
std::optional<std::filesystem::path> data_file(const std::string& name) {
  const char* folder = std::getenv("PALPATE_DATA");
  const std::filesystem::path root =
      folder != nullptr ? folder : PALPATE_SOURCE_DIR "/../shared/data";
  if (std::filesystem::exists(root / name)) return root / name;
  std::cout << "SKIPPED: no " << name << " in " << root.string() << "\n";
  return std::nullopt;
}

void check_organ(const std::string& name, std::size_t nodes, double volume_cm3) {
  const auto file = data_file("organs/" + name);
  if (!file) return;
  INFO(name);
  const TriangleSurface organ = load_organ_surface(*file, "mm", 0);
  const MeshReport report = check_surface(organ);
  CHECK(report.node_count == nodes);
  CHECK(report.triangle_count == 2 * nodes - 4);
  CHECK(report.genus == 0);
  CHECK(report.volume * 1e6 == Approx(volume_cm3).margin(0.51));  // given in whole cm³
  const MeshReport coarse = check_surface(load_organ_surface(*file, "mm", 550));
  CHECK(coarse.node_count == 550);
  CHECK(coarse.triangle_count == 1096);
  CHECK(coarse.holds_volume());
  CHECK(coarse.volume == Approx(report.volume).epsilon(1e-9));
  CHECK(coarse.longest_edge / coarse.shortest_edge < 4);
  CHECK(coarse.worst_aspect < 3);
}

std::string organ_refusal(const std::filesystem::path& file) {
  return message_of<InputError>([&] { load_organ_surface(file, "m", 0); });
}

}  // namespace

TEST_CASE("third-party organs: CT anatomy loads closed and decimates to 550 nodes") {
  // Oracle: measured counts and volumes that came with the data.
  check_organ("openhelp_stomach.stl", 4864, 289);
  check_organ("openhelp_liver.stl", 15'365, 1818);
  check_organ("openhelp_spleen.stl", 5409, 344);
}

TEST_CASE("third-party meshes: open and non-manifold, the inner wall goes, the holes are told") {
  // Oracle: what is known of the file: 20 open edges.
  const auto file = data_file("hard-meshes/sofa_c_open.obj");
  if (!file) return;
  const MeshReport raw = check_surface(read_surface(*file, "m"));
  CHECK(raw.border_edges.size() == 20);
  CHECK_FALSE(raw.non_manifold_edges.empty());
  CHECK_FALSE(raw.duplicate_triangles.empty());
  CHECK_THAT(organ_refusal(*file), Contains("sofa_c_open.obj: cannot hold a volume") &&
                                       Contains("20 open edges, the first: nodes") &&
                                       Contains("fill its holes"));
}

TEST_CASE("third-party meshes: VTK and Gmsh files are refused, saying what to convert to") {
  // Oracle: assimp reads neither.
  for (const char* name : {"hard-meshes/sofa_liver.vtk", "hard-meshes/sofa_6_tetra_bad.msh",
                           "hard-meshes/sofa_liver_for_test_broken.vtk",
                           "organs/gallbladder_tets.vtk", "organs/sofa_liver2_tets.msh"}) {
    const auto file = data_file(name);
    if (!file) return;
    CHECK_THAT(organ_refusal(*file), Contains(file->filename().string()) &&
                                         Contains("allowed: ply") && Contains("VTK or Gmsh"));
  }
}

TEST_CASE("third-party meshes: a triangle soup is open and in a hundred pieces") {
  // Oracle: 100 triangles without common nodes.
  const auto file = data_file("hard-meshes/trimesh_soup.stl");
  if (!file) return;
  CHECK_THAT(organ_refusal(*file), Contains("300 open edges") && Contains("100 separate shells") &&
                                       Contains("pass through each other"));
}

TEST_CASE("third-party meshes: cracks of a CAD file close, without that it crosses itself") {
  // Oracle: Euler's formula (V − E + F = 2 − 2·9 with 1,722 nodes), and an exact-arithmetic check
  // of all pairs of the merged surface, made once outside, that found no crossing.
  const auto file = data_file("hard-meshes/trimesh_featuretype.STL");
  if (!file) return;
  TriangleSurface surface = read_surface(*file, "in");
  const MeshReport raw = check_surface(surface);
  CHECK_FALSE(raw.border_edges.empty());
  CHECK_FALSE(raw.self_intersections.empty());
  repair_surface(surface);
  const MeshReport report = check_surface(surface);
  CHECK(report.node_count == 1722);
  CHECK(report.holds_volume());
  CHECK(report.genus == 9);
}

TEST_CASE("third-party meshes: a knot of genus one holds a volume") {
  // Oracle: topology of the file: a closed tube.
  const auto file = data_file("hard-meshes/trimesh_quadknot.obj");
  if (!file) return;
  const MeshReport report = check_surface(load_organ_surface(*file, "mm", 0));
  CHECK(report.genus == 1);
  CHECK(report.holds_volume());
}

TEST_CASE("third-party meshes: the wall between two joined tetrahedra is dropped") {
  // Oracle: six outer faces remain of eight.
  const auto file = data_file("hard-meshes/trimesh_joined_tetrahedra.obj");
  if (!file) return;
  CHECK(check_surface(read_surface(*file, "m")).duplicate_triangles.size() == 1);
  const TriangleSurface surface = load_organ_surface(*file, "m", 0);
  CHECK(surface.triangles.size() == 6);
}

TEST_CASE("third-party meshes: a cavity saved by itself is a sound solid") {
  // Oracle: Euler's formula for the file's counts.
  const auto file = data_file("hard-meshes/softrobots_Hollow_Bunny_Body_Cavity.obj");
  if (!file) return;
  const MeshReport report = check_surface(load_organ_surface(*file, "mm", 0));
  CHECK(report.holds_volume());
  CHECK(report.genus == 0);
  CHECK(report.triangle_count == 2 * report.node_count - 4);
}
