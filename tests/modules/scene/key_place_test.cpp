#include "modules/scene/key_place.h"

#include <catch2/catch.hpp>

#include "modules/scene/scene_reader.h"
#include "tests/modules/scene/scene_text.h"

namespace palpate::scene::test {

TEST_CASE("key place: a problem is told with the key's line, or that of what would hold it") {
  // Oracle: lines counted by hand.
  const SceneFolder folder;
  const auto file = folder.write("scene.yaml", R"(palpate_scene: 1
organs:
  - name: upper
    mesh: {file: organ.ply}
  - mesh: {file: organ.ply}
    name: lower
    fixed:
      - sphere: {center_m: [0, 0, 1], radius_m: 0.5}
probes:
  - shape: {sphere: {}}
    device: {topic: {start_m: [0, 0, 0.1]}}
)");
  const Scene scene = load_scene(file);
  const auto line = [&](const char* key) { return error_at(scene, key, "is wrong").line; };
  CHECK(line("organs[0]") == 3);
  CHECK(line("organs[1]") == 5);
  CHECK(line("organs[lower].name") == 6);
  CHECK(line("organs[lower].fixed[0]") == 8);
  CHECK(line("organs[lower].fixed[3]") == 8);  // not there: the list
  CHECK(line("organs[upper].fixed") == 3);
  CHECK(line("organs[7].fixed") == 3);
  CHECK(line("organs[nobody]") == 3);
  CHECK(line("contacts.self") == 1);
  CHECK(error_at(scene, "organs[1]", "is wrong").what() == file.string() + ":5: is wrong");

  const auto job = [](const Organ& organ) -> int { throw InputError(organ.name + " is wrong"); };
  CHECK_THROWS_WITH(with_organ(scene, 1, job), file.string() + ":5: lower is wrong");
  CHECK(with_organ(scene, 0, [](const Organ&) { return 5; }) == 5);

  std::filesystem::remove(file);  // of a text, or since
  CHECK(error_at(scene, "organs[0]", "is wrong").what() == file.string() + ": is wrong");
}

}  // namespace palpate::scene::test
