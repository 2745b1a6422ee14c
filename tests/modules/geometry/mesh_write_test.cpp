#include <cstring>

#include "modules/core/error.h"
#include "modules/geometry/gmsh_file.h"
#include "modules/geometry/mesh_check.h"
#include "modules/geometry/mesh_io.h"
#include "modules/geometry/primitives.h"
#include "tests/modules/geometry/scratch.h"

using namespace palpate;
using namespace palpate::geometry;
using namespace palpate::geometry::test;
using Catch::Contains;

TEST_CASE("write: every format comes back with the same shape and triangles") {
  // Oracle: round trip; formats and reader carry single precision, relative 2⁻²⁴ of 0.1 m.
  const ScratchFolder folder;
  const TriangleSurface surface = moved(make_ball(0.05, 2), {0.03, -0.02, 0.05});
  for (const char* extension : {"ply", "stl", "obj", "off"}) {
    INFO(extension);
    const auto file = folder / (std::string("ball.") + extension);
    write_surface(surface, file);
    const TriangleSurface back = read_surface(file, "m");
    REQUIRE(back.nodes.size() == surface.nodes.size());
    REQUIRE(back.triangles.size() == surface.triangles.size());
    double worst = 0;
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
      for (int i = 0; i < 3; ++i) {
        worst = std::max(
            worst,
            (back.nodes[back.triangles[t][i]] - surface.nodes[surface.triangles[t][i]]).norm());
      }
    }
    CHECK(worst < 1.5e-8);
    CHECK(check_surface(back).holds_volume());
  }
  CHECK(folder.file_count() == 4);  // no temporary file is left
}

TEST_CASE("write: the bytes of a binary PLY and STL are as the formats say") {
  // Oracle: the formats' definitions, by hand.
  const ScratchFolder folder;
  const TriangleSurface surface = make_tetrahedron(0.2);
  write_surface(surface, folder / "a.ply");
  const std::string ply = text_in(folder / "a.ply");
  CHECK_THAT(ply, Catch::StartsWith("ply\nformat binary_little_endian 1.0\n"));
  const std::size_t body = ply.find("end_header\n") + 11;
  CHECK(ply.size() - body == 4 * 12 + 4 * 13);
  float x = 0;
  std::memcpy(&x, ply.data() + body, sizeof x);
  CHECK(x == static_cast<float>(surface.nodes[0].x()));
  write_surface(surface, folder / "a.stl");
  CHECK(text_in(folder / "a.stl").size() == 80 + 4 + 4 * 50);
}

TEST_CASE("write: the same surface gives the same bytes, and an old file is replaced") {
  // Oracle: determinism.
  const ScratchFolder folder;
  folder.write("a.obj", "old");
  write_surface(make_ball(1, 1), folder / "a.obj");
  write_surface(make_ball(1, 1), folder / "b.obj");
  CHECK(text_in(folder / "a.obj") == text_in(folder / "b.obj"));
}

TEST_CASE("write: an extension in capitals is the same format") {
  // Oracle: the bytes of the other.
  const ScratchFolder folder;
  for (const auto& [small, large] : {std::pair{"a.ply", "a.PLY"}, {"a.stl", "a.Stl"}}) {
    write_surface(make_ball(1, 1), folder / small);
    write_surface(make_ball(1, 1), folder / large);
    CHECK(text_in(folder / small) == text_in(folder / large));
  }
}

TEST_CASE("write: an unknown extension is refused with what is allowed") {
  // Oracle: the rules of write_surface.
  const ScratchFolder folder;
  const auto message =
      message_of<InputError>([&] { write_surface(make_tetrahedron(1), folder / "a.vtk"); });
  CHECK_THAT(message, Contains("'.vtk'") && Contains("allowed: .ply, .stl, .obj, .off"));
  CHECK(folder.file_count() == 0);
}

TEST_CASE("write: a place that cannot be written gives an error and leaves nothing behind") {
  // Oracle: the rules of write_surface: a missing folder, and a folder in the file's place.
  const ScratchFolder folder;
  const auto missing = message_of<std::runtime_error>(
      [&] { write_surface(make_tetrahedron(1), folder / "no" / "a.ply"); });
  CHECK_THAT(missing, Contains("cannot be written"));
  std::filesystem::create_directory(folder / "taken.ply");
  const auto taken = message_of<std::runtime_error>(
      [&] { write_surface(make_tetrahedron(1), folder / "taken.ply"); });
  CHECK_THAT(taken, Contains("cannot be written"));
  CHECK(folder.file_count() == 1);
}

TEST_CASE("write: tetrahedra come back bit by bit, and only as msh") {
  // Oracle: what was written; thirds and a tenth have no short decimals.
  const ScratchFolder folder;
  TetMesh mesh;
  mesh.nodes = {{0, 0, 0}, {1.0 / 3, 0, 0}, {0, 0.1, 1e-17}, {0, 2e-5 / 3, 1e-3}, {0, 1, 1.0 / 7}};
  mesh.tetrahedra = {{0, 1, 2, 3}, {3, 1, 2, 4}};
  write_tetrahedra(mesh, folder / "a.msh");
  const TetMesh read = read_gmsh(folder / "a.msh");
  CHECK(read.nodes == mesh.nodes);
  CHECK(read.tetrahedra == mesh.tetrahedra);
  const auto message = message_of<InputError>([&] { write_tetrahedra(mesh, folder / "a.ply"); });
  CHECK_THAT(message, Contains("'.ply'") && Contains("allowed: .msh"));
  CHECK(folder.file_count() == 1);
}
