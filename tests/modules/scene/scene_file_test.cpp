#include "modules/scene/scene_file.h"

#include "tests/modules/scene/scene_text.h"

namespace palpate::scene {

TEST_CASE("scene file: a file goes before a name, what is neither is refused, a mesh sent on") {
  // Oracle: definition; a scene that is shipped.
  const test::SceneFolder folder;
  const auto file = folder.write("press.yaml", "palpate_scene: 1\n");
  CHECK(scene_file(file) == file);
  CHECK_THROWS_WITH(scene_file("/nowhere/x.yaml"),
                    Catch::Contains("/nowhere/x.yaml: no such file"));
  CHECK_THROWS_WITH(scene_file("stomach_prob"), Catch::Contains("palpate list scenes"));
  CHECK_THROWS_WITH(scene_file(folder / "organ.ply"), Catch::Contains("palpate new"));
  CHECK(scene_file("").empty());
  CHECK(scene_file("stomach_probe").filename() == "stomach_probe.yaml");
  CHECK(is_shipped(scene_file("stomach_probe")));
  CHECK_FALSE(is_shipped(file));
}

TEST_CASE("scene file: a folder does not hide the shipped scene of its name") {
  // Oracle: definition; the folder is the one that `--out stomach_probe` leaves.
  const test::SceneFolder folder;
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(folder.path());
  std::filesystem::create_directories("stomach_probe");
  std::filesystem::create_directories("mine");
  const auto shipped = scene_file("stomach_probe"), mine = scene_file("mine");
  std::filesystem::current_path(before);
  CHECK(is_shipped(shipped));
  CHECK(mine == "mine");  // whoever reads it says that it is a folder
}

}  // namespace palpate::scene
