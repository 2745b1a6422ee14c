#include "modules/scene/settings.h"

#include <fstream>

#include "tests/modules/scene/scene_text.h"

using namespace palpate;
using namespace palpate::scene;
using namespace palpate::scene::test;

namespace {

Scene parse(const SceneFolder& folder, const std::vector<std::string>& settings) {
  std::ofstream(folder.path() / "scene.yaml") << kMinimalScene;
  return load_scene_with(folder.path() / "scene.yaml", settings);
}

std::string refusal(const SceneFolder& folder, const std::vector<std::string>& settings) {
  try {
    parse(folder, settings);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("settings: a key is changed whether the file has it or leaves it out") {
  // Oracle: the numbers that were set.
  const SceneFolder folder;
  const Scene scene =
      parse(folder, {"organs[0].tissue.youngs_modulus_pa=8e3", "rates.deformation_hz=200",
                     "probes[0].shape={sphere: {radius_m: 0.004}}", "gravity_m_per_s2=[0, 0, -9]"});
  CHECK(scene.organs[0].tissue.youngs_modulus == 8e3);
  CHECK(scene.rates.deformation == 200);
  CHECK(std::get<SphereShape>(scene.probes[0].shape).radius == 0.004);
  CHECK(scene.gravity == Vec3(0, 0, -9));
  CHECK(parse(folder, {"organs[0].tissue.youngs_modulus_pa=010000"})
            .organs[0]
            .tissue.youngs_modulus == 1e4);  // decimal, as in a file
  CHECK_THAT(refusal(folder, {"organs[0].tissue.youngs_modulus_pa=0x4000"}),
             Catch::Contains("0x4000"));
  CHECK(scene.file == folder.path() / "scene.yaml");
}

TEST_CASE("settings: two keys that only fit together are judged together") {
  // Oracle: the schema's rule that inner springs need virtual nodes.
  const SceneFolder folder;
  CHECK(refusal(folder, {"organs[0].springs.virtual_nodes=0"}) != "");
  const Scene scene =
      parse(folder, {"organs[0].springs.virtual_nodes=0", "organs[0].springs.inner_ratio=0"});
  CHECK(scene.organs[0].springs.virtual_nodes == 0);
}

TEST_CASE("settings: the schema judges what was set") {
  // Oracle: the reader's own messages, with the setting in the place of a line of the file, which
  // is sound.
  const SceneFolder folder;
  CHECK(refusal(folder, {"rates.haptics_hz=1000", "rates.deformation_hz=-1"})
            .find("--set rates.deformation_hz=-1: key 'rates.deformation_hz'") == 0);
  CHECK(refusal(folder, {"rates={deformation_hz: -1}"})
            .find("--set rates={deformation_hz: -1}: key") == 0);
  CHECK_THAT(refusal(folder, {"organs[0].springs.virtual_nodes=0"}),
             Catch::StartsWith("--set organs[0].springs.virtual_nodes=0: ") ||
                 Catch::EndsWith("(with what --set changes)"));
  CHECK_THAT(refusal(folder, {"organs[0].tissue.youngs_modulus=8e3"}),
             Catch::Contains("organs[0].tissue.youngs_modulus") &&
                 Catch::Contains("did you mean 'youngs_modulus_pa'?"));
  CHECK_THAT(refusal(folder, {"rates.deformation_hz=fast"}), Catch::Contains("'fast'"));
  CHECK_THAT(refusal(folder, {"rates.deformation_hz=-1"}), Catch::Contains("'-1'"));
}

TEST_CASE("settings: what is not a setting is refused in one line") {
  // Oracle: texts that are wrong by construction.
  const SceneFolder folder;
  for (const char* setting :
       {"", "=", "rates", "=3", "rates.=3", "organs[7].model=mass_spring", "organs[x].model=a",
        "organs[0.model=a", "organs[].model=a", "organs[-1].model=a", "duration_s.deep=1", "..=1",
        "[0]=1", "gravity_m_per_s2=[0", "organs[0].name.a.b=1", "name=&a [*a]",
        "organs=&a [{b: *a}]", "duration_s=1\n--- \n2", "contacts={self: true, self: true}"}) {
    INFO(setting);
    const std::string said = refusal(folder, {setting});
    CHECK(said != "");
    CHECK(said.find('\n') == std::string::npos);
  }
}
