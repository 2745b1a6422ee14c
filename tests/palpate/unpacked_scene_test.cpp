#include "palpate/unpacked_scene.h"

#include <catch2/catch.hpp>
#include <sstream>

#include "modules/recording/recorder.h"
#include "modules/scene/placed_files.h"
#include "modules/scene/scene_reader.h"
#include "tests/modules/recording/payloads.h"
#include "tests/palpate/ball_scene.h"

using namespace palpate;
using namespace palpate::launcher;

namespace {

using recording::raw_sample;

/// A recording that was told this scene.
void record(const scene::Scene& scene, const std::filesystem::path& file) {
  SceneDescription told;
  told.header = {1, 0, 1, 0};
  told.name = scene.name;
  told.digest = scene::scene_digest(scene);
  told.resolved_text = scene::resolved_text(scene);
  recording::SampleFile writer(file, {});
  writer.add(raw_sample(bus::kScene, told, 5));
  writer.close();
}

}  // namespace

TEST_CASE("unpacked scene: files are where they were, or the recording's own under its names") {
  // Oracle: the digest of the scene, which is of the files' bytes; the text that was told.
  const palpate::testing::BallScene files;
  const scene::Scene scene = scene::load_scene(files.file());
  const auto file = files.folder() / "a.mcap", folder = files.folder() / "unpacked";
  record(scene, file);
  std::filesystem::create_directory(folder);
  std::ostringstream log;
  const UnpackedScene there(file, folder, log);
  CHECK(there.taken().empty());
  CHECK(there.here().resolved_text == scene::resolved_text(scene));
  CHECK(log.str().empty());
  const std::string digest = scene::scene_digest(scene);
  std::filesystem::remove(files.folder() / "ball.ply");
  const UnpackedScene gone(file, folder, log);
  REQUIRE(gone.taken().size() == 1);
  CHECK(gone.taken()[0].name == "ball.ply");
  CHECK(scene::scene_digest(scene::load_scene(gone.file())) == digest);
  CHECK(gone.here().resolved_text != there.here().resolved_text);
  CHECK(gone.as_told(gone.here().resolved_text) == there.here().resolved_text);
  CHECK_THAT(log.str(), Catch::Contains("ball.ply: is not there; taken from the recording"));
}

TEST_CASE("unpacked scene: two meshes of one name are told apart by their places") {
  // Oracle: the digest, which is of the files' bytes in the order of the organs.
  const palpate::testing::BallScene files;
  namespace fs = std::filesystem;
  for (const char* folder : {"b", "a"}) fs::create_directory(files.folder() / folder);
  const auto ball = geometry::make_ball(0.05, 3), small = geometry::make_ball(0.03, 3);
  geometry::write_surface(ball, files.folder() / "b" / "organ.ply");
  geometry::write_surface(small, files.folder() / "a" / "organ.ply");
  scene::Scene scene = scene::load_scene(files.file());
  scene.organs.push_back(scene.organs[0]);
  scene.organs[1].name = "small";
  scene.organs[1].pose.position.x() = 0.2;
  scene.organs[0].mesh.file = files.folder() / "b" / "organ.ply";
  scene.organs[1].mesh.file = files.folder() / "a" / "organ.ply";
  const auto file = files.folder() / "a.mcap", folder = files.folder() / "unpacked";
  record(scene, file);
  const std::string digest = scene::scene_digest(scene);
  for (const char* name : {"b", "a"}) fs::remove_all(files.folder() / name);
  fs::create_directory(folder);
  std::ostringstream log;
  const UnpackedScene gone(file, folder, log);
  CHECK(gone.taken().size() == 2);
  CHECK(scene::scene_digest(scene::load_scene(gone.file())) == digest);
}
