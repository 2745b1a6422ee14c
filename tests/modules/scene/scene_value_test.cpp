#include "modules/scene/scene_value.h"

#include "modules/scene/scene_document.h"
#include "tests/modules/scene/scene_text.h"

namespace palpate::scene::test {
namespace {

TEST_CASE("scene value: numbers, words, texts, lists and absent keys come as what they are") {
  // Oracle: definition.
  const SceneFolder folder;
  const SceneDocument scene(kMinimalScene, folder.path() / "scene.yaml");
  CHECK(std::get<double>(scene.value("rates.haptics_hz").content) == 1000);
  CHECK(std::get<std::int64_t>(scene.value("deformation_threads").content) == 1);
  CHECK(std::get<bool>(scene.value("contacts.self").content) == false);
  CHECK(std::get<std::string>(scene.value("organs[0].integrator").content) == "automatic");
  CHECK(std::get<std::string>(scene.value("organs[0].mesh.file").content) ==
        (folder.path() / "organ.ply").string());
  CHECK(std::get<SceneValue::List>(scene.value("gravity_m_per_s2").content).size() == 3);
  CHECK(std::holds_alternative<std::monostate>(scene.value("camera.position_m").content));
}

}  // namespace
}  // namespace palpate::scene::test
