#include "modules/geometry/ply_file.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstring>

#include "modules/core/error.h"
#include "modules/geometry/mesh_io.h"
#include "modules/geometry/primitives.h"
#include "tests/modules/geometry/damaged_meshes.h"
#include "tests/scratch_folder.h"

namespace palpate::geometry {
namespace {

const std::string kPyramid =
    "element vertex 5\nproperty float x\nproperty double y\nproperty short z\nproperty uchar red\n"
    "element edge 1\nproperty list int float lengths\n"
    "element face 2\nproperty list uchar uint vertex_index\nproperty int8 side\nend_header\n";

/// The same pyramid's top and base, in binary of either order.
std::string binary_pyramid(bool little) {
  std::string bytes;
  const auto put = [&](auto number) {
    std::string part(sizeof number, '\0');
    std::memcpy(part.data(), &number, sizeof number);
    if (!little) std::ranges::reverse(part);
    bytes += part;
  };
  const double places[5][3] = {{0, 0, 0}, {1, 0, 0}, {1, 2.5, 0}, {0, 2.5, 0}, {0.1, 0.3, 7}};
  for (const auto& place : places) {
    put(static_cast<float>(place[0]));
    put(place[1]);
    put(static_cast<std::int16_t>(place[2]));
    put(std::uint8_t{'\n'});
  }
  put(std::int32_t{2});
  put(1.0f);
  put(2.0f);
  put(std::uint8_t{4});
  for (const std::uint32_t node : {3u, 2u, 1u, 0u}) put(node);
  put(std::int8_t{-1});
  put(std::uint8_t{3});
  for (const std::uint32_t node : {0u, 1u, 4u}) put(node);
  put(std::int8_t{1});
  return bytes;
}

void check_pyramid(const TriangleSurface& surface) {
  REQUIRE(surface.nodes.size() == 5);
  CHECK(surface.nodes[2] == Vec3(1, 2.5, 0));
  CHECK(surface.nodes[4] == Vec3(double(0.1f), 0.3, 7));
  CHECK(surface.triangles == std::vector<Triangle>{{3, 2, 1}, {3, 1, 0}, {0, 1, 4}});
}

std::string refusal_of(const std::string& bytes) {
  return test::refusal_by(parse_ply, bytes, "a.ply");
}

TEST_CASE("ply file: text and both byte orders, other elements, lists and types") {
  // Oracle: a pyramid's base and one side, by hand.
  check_pyramid(parse_ply("ply\r\nformat ascii 1.0\r\ncomment by hand\r\n" + kPyramid +
                              "0 0 0 9\n1 0 0 9\n1 +2.5 0 9\n0 2.5 0 9\n.1 3e-1 7 9\n2 1 2\n"
                              "4 3 2 1 0 -1\n3 0 1 4 1\n",
                          "a.ply"));
  check_pyramid(parse_ply(
      "ply\nformat binary_little_endian 1.0\n" + kPyramid + binary_pyramid(true), "a.ply"));
  check_pyramid(
      parse_ply("ply\nformat binary_big_endian 1.0\n" + kPyramid + binary_pyramid(false), "a.ply"));
}

TEST_CASE("ply file: data that begin like a line end are data") {
  // Oracle: round trip; −0.02f is 0xbca3d70a, its first byte a line feed.
  const auto box = make_box(Vec3(0.04, 0.06, 0.08));
  const ScratchFolder folder;
  const auto file = folder / "box.ply";
  write_surface(box, file);
  const auto again = read_surface(file, "m");
  REQUIRE(again.nodes.size() == box.nodes.size());
  for (std::size_t i = 0; i < box.nodes.size(); ++i) {
    CHECK((again.nodes[i] - box.nodes[i]).norm() < 1e-8);
  }
}

TEST_CASE("ply file: what is wrong is named with its line or its element") {
  // Oracle: the messages promised.
  using Catch::Contains;
  const std::string head = "ply\nformat ascii 1.0\n";
  CHECK(refusal_of("play\n") == "a.ply:1: must be 'ply'");
  CHECK(refusal_of("ply\nformat ascii 1.0\nelement vertex 3\n") ==
        "a.ply: its header has no end ('end_header')");
  CHECK(refusal_of("ply\nend_header\n") == "a.ply:2: comes before any 'format'");
  CHECK(refusal_of("ply\nformat base64 1.0\n") ==
        "a.ply:2: 'format base64 1.0' must name ascii, binary_little_endian or binary_big_endian");
  CHECK(refusal_of(head + "vertex 3\n") == "a.ply:3: 'vertex 3' is no line of a PLY header");
  CHECK(refusal_of(head + "element vertex many\n") ==
        "a.ply:3: 'element vertex many' must end in a number");
  for (const char* property : {"property floatB x", "property float", "property list float int x",
                               "property list uchar x"}) {
    CHECK_THAT(refusal_of(head + "element vertex 3\n" + property + "\n"),
               Contains("a.ply:4: '") && Contains("must be"));
  }
  CHECK_THAT(refusal_of(head + "element vertex 1\nproperty float x\nend_header\n1\n"),
             Contains("must hold an element"));
  CHECK_THAT(refusal_of(head + kPyramid + "0 0 0 9\n1 0 zero 9\n"),
             Contains("vertex 1 of 5 holds 'zero', which is no number"));
  CHECK_THAT(refusal_of(head + kPyramid + "0 0 0 9\n1 0 0"),
             Contains("vertex 1 of 5 is not there"));
  const std::string nodes = "0 0 0 9 0 0 0 9 0 0 0 9 0 0 0 9 0 0 0 9 0\n";
  CHECK_THAT(refusal_of(head + kPyramid + nodes + "3 0 1 5 0"),
             Contains("face 0 of 2 names vertex 5; allowed: 0 to 4"));
  CHECK_THAT(refusal_of(head + kPyramid + nodes + "3 0 -1 2 0"), Contains("names vertex -1"));
  CHECK_THAT(refusal_of(head + kPyramid + nodes + "3 0 nan 2 0"), Contains("names vertex nan"));
  CHECK_THAT(refusal_of(head + kPyramid + nodes + "1e12 0"),
             Contains("a list of 1000000000000 entries"));
}

TEST_CASE("ply file: 3,000 damaged files are read or refused") {
  // Oracle: no crash (the sanitizers' build looks closer), and what is read names its own nodes.
  const ScratchFolder folder;
  write_surface(make_ball(0.05, 1), folder / "ball.ply");
  std::ifstream stream(folder / "ball.ply", std::ios::binary);
  const std::string whole{std::istreambuf_iterator<char>(stream), {}};
  test::DamagedFiles damaged(whole);
  int read = 0;
  for (int i = 0; i < 3000; ++i) {
    const std::string bytes = damaged.next();
    try {
      const TriangleSurface surface = parse_ply(bytes, "a.ply");
      ++read;
      for (const Triangle& triangle : surface.triangles) {
        CHECK(std::ranges::max(triangle) < surface.nodes.size());
      }
    } catch (const InputError&) {
    }
  }
  CHECK(read > 0);
  CHECK(read < 3000);
}

}  // namespace
}  // namespace palpate::geometry
