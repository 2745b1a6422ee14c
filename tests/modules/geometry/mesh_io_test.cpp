#include "modules/geometry/mesh_io.h"

#include "modules/core/error.h"
#include "modules/geometry/mesh_check.h"
#include "modules/geometry/primitives.h"
#include "tests/modules/geometry/scratch.h"

using namespace palpate;
using namespace palpate::geometry;
using namespace palpate::geometry::test;
using Catch::Contains;

namespace {

const std::string kTetrahedronObj =
    "v 0 0 0\nv 10 0 0\nv 0 10 0\nv 0 0 10\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

std::string refusal(const std::filesystem::path& file, std::string_view unit = "m") {
  return message_of<InputError>([&] { read_surface(file, unit); });
}

}  // namespace

TEST_CASE("read: numbers are scaled by the unit") {
  // Oracle: analytic, a corner tetrahedron of 10 units has 1000/6 units³.
  const ScratchFolder folder;
  const auto file = folder.write("a.obj", kTetrahedronObj);
  for (const auto& [unit, metres] :
       {std::pair{"m", 1.0}, {"cm", 0.01}, {"mm", 0.001}, {"in", 0.0254}}) {
    const TriangleSurface surface = read_surface(file, unit);
    CHECK(surface.nodes.size() == 4);
    CHECK(enclosed_volume(surface.nodes, surface.triangles) ==
          Approx(1000.0 / 6 * metres * metres * metres).epsilon(1e-12));
  }
  CHECK_THAT(refusal(file, "furlong"), Contains("furlong") && Contains("allowed: m, dm"));
}

TEST_CASE("read: polygons are triangulated, normals and texture do not split nodes") {
  // Oracle: hand-written unit cube of six quads with six normals, volume 1.
  const ScratchFolder folder;
  const auto file = folder.write(
      "cube.obj",
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
      "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
      "vn 0 0 -1\nvn 0 0 1\nvn 0 -1 0\nvn 1 0 0\nvn 0 1 0\nvn -1 0 0\n"
      "f 1/1/1 4/2/1 3/3/1 2/4/1\nf 5/1/2 6/2/2 7/3/2 8/4/2\nf 1/1/3 2/2/3 6/3/3 5/4/3\n"
      "f 2/1/4 3/2/4 7/3/4 6/4/4\nf 3/1/5 4/2/5 8/3/5 7/4/5\nf 4/1/6 1/2/6 5/3/6 8/4/6\n");
  const MeshReport report = check_surface(read_surface(file, "m"));
  CHECK(report.node_count == 8);
  CHECK(report.triangle_count == 12);
  CHECK(report.holds_volume());
  CHECK(report.volume == Approx(1).epsilon(1e-12));
}

TEST_CASE("read: several meshes of one file are put together") {
  // Oracle: hand-written file, two groups.
  const ScratchFolder folder;
  const auto file = folder.write("two.obj", "o one\n" + kTetrahedronObj +
                                                "o two\nv 20 0 0\nv 30 0 0\nv 20 10 0\nv 20 0 10\n"
                                                "f 5 7 6\nf 5 6 8\nf 5 8 7\nf 6 7 8\n");
  const MeshReport report = check_surface(read_surface(file, "m"));
  CHECK(report.component_count == 2);
  CHECK(report.volume == Approx(2000.0 / 6).epsilon(1e-12));
}

TEST_CASE("read: transforms of a file's nodes are applied") {
  // Oracle: analytic, a tetrahedron scaled by 2 and shifted in a Collada scene graph.
  const ScratchFolder folder;
  const auto file = folder.write("a.dae", R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="meter" meter="1"/><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="12">0 0 0 1 0 0 0 1 0 0 0 1</float_array>
<technique_common><accessor source="#pa" count="4" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/>
<p>0 2 1 0 1 3 0 3 2 1 2 3</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n">
<matrix>2 0 0 5 0 2 0 0 0 0 2 0 0 0 0 1</matrix><instance_geometry url="#g"/></node>
</visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>)");
  const MeshReport report = check_surface(read_surface(file, "m"));
  CHECK(report.holds_volume());
  CHECK(report.volume == Approx(8.0 / 6).epsilon(1e-6));  // single precision inside assimp
  CHECK(report.min_corner.x() == Approx(5).epsilon(1e-6));
}

TEST_CASE("read: a small file that places a mesh very often is refused") {
  // Oracle: arithmetic: 15,001 times 1,000 triangles and their corners are over 30 million.
  const ScratchFolder folder;
  std::string numbers, corners, nodes;
  for (int i = 0; i < 1002; ++i) numbers += std::to_string(i % 7) + " " + std::to_string(i) + " 0 ";
  for (int i = 0; i < 1000; ++i) {
    for (int k = 0; k < 3; ++k) corners += std::to_string(i + k) + " ";
  }
  for (int i = 0; i < 15'001; ++i) nodes += "<node><instance_geometry url=\"#g\"/></node>\n";
  const auto file = folder.write("often.dae", R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="3006">)" +
                                                  numbers +
                                                  R"(</float_array>
<technique_common><accessor source="#pa" count="1002" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="1000"><input semantic="VERTEX" source="#v" offset="0"/>
<p>)" + corners + R"(</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s">)" + nodes +
                                                  R"(</visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>)");
  CHECK_THAT(refusal(file), Contains("often.dae: places its meshes so often") &&
                                Contains("at most 30000000 are allowed"));
}

TEST_CASE("read: a missing file, a folder and an empty file are refused by name") {
  // Oracle: the rules of read_surface.
  const ScratchFolder folder;
  CHECK_THAT(refusal(folder / "nowhere.stl"), Contains("nowhere.stl: no such file"));
  CHECK_THAT(refusal(folder / "."), Contains("is a folder, not a file"));
  CHECK_THAT(refusal(folder.write("empty.ply", "")), Contains("empty.ply: is empty"));
}

TEST_CASE("read: unknown formats and rubbish are refused, saying what is allowed") {
  // Oracle: the rules of read_surface.
  const ScratchFolder folder;
  const auto vtk = folder.write("liver.vtk", "# vtk DataFile Version 3.0\nx\nASCII\n");
  CHECK_THAT(refusal(vtk), Contains("liver.vtk") && Contains("allowed: ply, stl, obj, off") &&
                               Contains("VTK or Gmsh"));
  const auto rubbish = folder.write("noise.ply", "ply\nformat zork 7.0\nend_header\n\x01\x02");
  CHECK_THAT(refusal(rubbish), Contains("noise.ply"));
  const auto cut = folder.write("cut.stl", std::string(80, 'x') + "\xff\xff\xff\x0f" + "abc");
  CHECK_THAT(refusal(cut), Contains("cut.stl"));
}

TEST_CASE("read: points and lines alone are no surface") {
  // Oracle: the rules of read_surface.
  const ScratchFolder folder;
  const auto file = folder.write("line.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nl 1 2 3\n");
  CHECK_THAT(refusal(file), Contains("line.obj: holds no triangles"));
}

TEST_CASE("read: an OFF file with an empty line before its faces is read") {
  // Oracle: both triangles are there.
  const ScratchFolder folder;
  const auto file =
      folder.write("gap.off", "OFF\n4 2 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n\n3 0 1 2\n3 0 2 3\n");
  CHECK(read_surface(file, "m").triangles.size() == 2);
}

TEST_CASE("read: indices out of range are refused") {
  // Oracle: the rules of read_surface; a triangle naming vertex 7 of four.
  const ScratchFolder folder;
  const auto ply = folder.write(
      "index.ply",
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
      "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 7\n");
  CHECK_THAT(refusal(ply), Contains("index.ply"));
  const auto obj = folder.write("index.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
  CHECK_THAT(refusal(obj), Contains("index.obj"));
}

TEST_CASE("read: coordinates that are not finite are refused") {
  // Oracle: the rules of read_surface; a binary PLY with a NaN.
  const ScratchFolder folder;
  TriangleSurface surface = make_tetrahedron(1);
  surface.nodes[2].y() = std::numeric_limits<double>::quiet_NaN();
  write_surface(surface, folder / "nan.ply");
  CHECK_THAT(refusal(folder / "nan.ply"), Contains("vertex 2 is not finite"));
  surface.nodes[2].y() = std::numeric_limits<double>::infinity();
  write_surface(surface, folder / "inf.ply");
  CHECK_THAT(refusal(folder / "inf.ply"), Contains("not finite"));
}
