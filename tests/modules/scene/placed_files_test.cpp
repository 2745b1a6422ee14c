#include "modules/scene/placed_files.h"

#include <catch2/catch.hpp>

#include "modules/core/error.h"
#include "modules/geometry/mesh_io.h"
#include "modules/geometry/primitives.h"
#include "modules/scene/scene_reader.h"
#include "tests/scratch_folder.h"

namespace palpate::scene {
namespace {

using Files = std::vector<std::filesystem::path>;

TEST_CASE("placed files: the text names them, wherever, and others in their place") {
  // Oracle: the files by hand; the scene that is read.
  const ScratchFolder folder;
  geometry::write_surface(geometry::make_ball(0.05, 2), folder / "ball.ply");
  const Scene scene = parse_scene(
      "palpate_scene: 1\n"
      "organs: [{name: ball, mesh: {file: ball.ply}, fixed: []}]\n"
      "probes: [{name: finger, shape: {sphere: {radius_m: 0.01}},\n"
      "          device: {topic: {start_m: [0, 0, 0.09]}}}]\n",
      folder / "scene.yaml");
  const std::string text = resolved_text(scene);
  CHECK(files_named(text) == Files{folder / "ball.ply"});
  const auto other = folder / "with \"quotes\" and \\.ply";
  std::filesystem::copy_file(folder / "ball.ply", other);
  const auto to_other = [&](const std::filesystem::path&) { return other; };
  const std::string moved = with_files(text, to_other);
  CHECK(files_named(moved) == Files{other});
  CHECK(parse_scene(moved, "moved").organs[0].mesh.file == other);
  CHECK(with_files(moved, [&](const std::filesystem::path& file) {
          CHECK(file == other);
          return folder / "ball.ply";
        }) == text);
  CHECK(with_files(text, [](const std::filesystem::path& file) { return file; }) == text);
}

TEST_CASE("placed files: probes have their names without the files") {
  // Oracle: the names by hand; the mesh is nowhere.
  CHECK(probe_names("organs: [{mesh: {file: nowhere.ply}}]\n"
                    "probes: [{name: finger, shape: {}}, {shape: {}}, {name: rod}]\n") ==
        std::vector<std::string>{"finger", "", "rod"});
  for (const char* text : {"3", "probes: 3", "a: b"}) CHECK(probe_names(text).empty());
  CHECK_THROWS_AS(probe_names("a: [b"), InputError);
}

TEST_CASE("placed files: of a text that is somebody else's") {
  // Oracle: by hand; they need not be there.
  CHECK(files_named("").empty());
  CHECK(files_named("a: {file: /no/x}\nb: [{file: y}, {file: [z]}]\n") == Files{"/no/x", "y"});
  CHECK(files_named("a: &a {file: x, more: *a}\n").size() < 100);  // an anchor that holds itself
  CHECK_THROWS_AS(files_named("a: [\n"), InputError);
}

}  // namespace
}  // namespace palpate::scene
