#include "modules/geometry/ply_bytes.h"

#include <catch2/catch.hpp>
#include <filesystem>

#include "modules/geometry/mesh_io.h"
#include "modules/geometry/primitives.h"
#include "tests/scratch_folder.h"

namespace palpate::geometry {
namespace {

TEST_CASE("ply bytes: only a line end that is the first byte of binary data is changed") {
  // Oracle: definition, by hand.
  const std::string header = "ply\nformat binary_little_endian 1.0\nend_header\n";
  for (const auto& [first, expected] :
       {std::pair{'\n', '\x0b'}, {'\r', '\x0c'}, {'a', 'a'}, {' ', ' '}}) {
    std::string ply = header + first + "\n\r";
    protect_first_data_byte(ply);
    CHECK(ply == header + expected + "\n\r");
  }
  for (const std::string& untouched :
       {std::string("ply\nformat ascii 1.0\nend_header\n\n1 2 3"),
        std::string("solid\nend_header\n\n"), header, std::string("ply"), std::string()}) {
    std::string ply = untouched;
    protect_first_data_byte(ply);
    CHECK(ply == untouched);
  }
}

TEST_CASE("ply bytes: a box whose first coordinate begins with 0x0a comes back") {
  // Oracle: round trip; −0.02f is 0xbca3d70a. One part in 10⁷ of 2 cm.
  const auto box = make_box(Vec3(0.04, 0.06, 0.08));
  const ScratchFolder folder;
  const auto file = folder / "box.ply";
  write_surface(box, file);
  const auto again = read_surface(file, "m");
  REQUIRE(again.nodes.size() == box.nodes.size());
  for (std::size_t i = 0; i < box.nodes.size(); ++i) {
    CHECK((again.nodes[i] - box.nodes[i]).norm() < 1e-8);
  }
  CHECK(again.triangles.size() == box.triangles.size());
}

}  // namespace
}  // namespace palpate::geometry
