#include "modules/geometry/gmsh_file.h"

#include <catch2/catch.hpp>

#include "modules/core/error.h"
#include "tests/scratch_folder.h"

namespace palpate::geometry {
namespace {

const std::string kFormat = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
const std::string kNodes = "$Nodes\n5\n9 7 7 7\n2 0 0 0\n3 1 0 0\n5 0 1 0\n8 0 0 1\n$EndNodes\n";

TEST_CASE("gmsh file: tetrahedra are read, other elements and unused nodes left out") {
  // Oracle: the text, read by eye.
  const ScratchFolder folder;
  const auto text = folder.write(
      "mesh.msh", kFormat + "$Comments\nanything\n$EndComments\n" + kNodes +
                      "$Elements\n3\n1 15 2 0 1 9\n2 2 2 0 1 2 3 5\n3 4 2 0 1 2 3 5 8\n"
                      "$EndElements\n");
  const auto mesh = read_gmsh(text);
  REQUIRE(mesh.nodes.size() == 4);
  CHECK(mesh.nodes[3] == Vec3(0, 0, 1));
  REQUIRE(mesh.tetrahedra.size() == 1);
  CHECK(mesh.tetrahedra[0] == Tetrahedron{0, 1, 2, 3});
}

TEST_CASE("gmsh file: what is wrong is named with its line") {
  // Oracle: the stated messages.
  const std::string elements = "$Elements\n1\n1 4 0 2 3 5 8\n$EndElements\n";
  const auto [text, message] = GENERATE_COPY(table<std::string, std::string>({
      {"$MeshFormat\n4.1 0 8\n$EndMeshFormat\n", ":2: format \"4.1 0\"; allowed: 2.2 0"},
      {"$MeshFormat\n2.2 1 8\n$EndMeshFormat\n", ":2: format \"2.2 1\""},
      {kNodes, ":1: \"$Nodes\"; allowed: $MeshFormat first"},
      {"solid ball\n", ":1: \"solid\""},
      {kFormat + "$Nodes\n1\n1 0 x 0\n", ":6: \"x\"; allowed: a number"},
      {kFormat + "$Nodes\n1\n1 0 nan 0\n", ":6: \"nan\"; allowed: finite"},
      {kFormat + "$Nodes\n1\n1 0 0\n", ":6: only 3 words"},
      {kFormat + "$Nodes\n2\n1 0 0 0\n1 1 0 0\n", ":7: node 1 stands twice"},
      {kFormat + "$Nodes\n-3\n", ":5: \"-3\"; allowed: whole numbers from 1"},
      {kFormat + "$Nodes\n2\n1 0 0 0\n", ": the file ends within $Nodes"},
      {kFormat + "$Nodes\n1\n1 0 0 0\n2 1 0 0\n", ":7: \"2\"; allowed: $EndNodes"},
      {kFormat + kNodes + "$Elements\n1\n1 4 0 2 3 5 6\n", ":14: no node 6"},
      {kFormat + kNodes + "$Elements\n1\n1 5 0 2 3 5 8\n", ":14: element kind 5; allowed: 4"},
      {kFormat + kNodes + "$Elements\n1\n1 4 0 3 2 5 8\n$EndElements\n",
       ":14: the tetrahedron is flat or inside out"},
      {kFormat + kNodes + "$Elements\n2\n1 4 0 2 3 5 8\n1 4 0 2 3 5 8\n",
       ":15: element 1 stands twice"},
      {kFormat + kNodes, "no tetrahedra"},
  }));
  const ScratchFolder folder;
  const auto file = folder.write("mesh.msh", text);
  CHECK_THROWS_AS(read_gmsh(file), InputError);
  CHECK_THROWS_WITH(read_gmsh(file), Catch::StartsWith(file.string()) && Catch::Contains(message));
}

TEST_CASE("gmsh file: a missing file is named") {
  // Oracle: the stated message.
  CHECK_THROWS_WITH(read_gmsh("/nowhere/x.msh"), "/nowhere/x.msh: no such file");
}

}  // namespace
}  // namespace palpate::geometry
