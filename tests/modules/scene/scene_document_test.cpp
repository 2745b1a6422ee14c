#include "modules/scene/scene_document.h"

#include <functional>

#include "modules/scene/scene_error.h"
#include "tests/modules/scene/scene_text.h"

namespace palpate::scene::test {
namespace {

using Changes = std::vector<SceneDocument::Change>;

SceneDocument document(const SceneFolder& folder, const std::string& text = kMinimalScene) {
  return {text, folder.path() / "scene.yaml"};
}

/// Line and key of a refusal; the document stays as it was.
std::pair<int, std::string> refused(SceneDocument& document, const Changes& changes) {
  const std::string before = resolved_text(document.scene());
  try {
    document.change(changes);
  } catch (const SceneError& error) {
    CHECK(resolved_text(document.scene()) == before);
    return {error.line, error.key};
  }
  return {-1, "accepted"};
}

double number(const SceneDocument& document, const std::string& path) {
  return std::get<double>(document.value(path).content);
}

TEST_CASE("scene document: a key that is changed is what a file with it would be") {
  // Oracle: the reader, given a text with that key.
  const SceneFolder folder;
  for (const auto& [path, value] :
       Changes{{"organs[0].tissue.youngs_modulus_pa", {8e3}},
               {"organs[0].springs.virtual_nodes", {std::int64_t{7}}},
               {"organs[0].position_m", {SceneValue::List{{0.1}, {std::int64_t{0}}, {-0.5}}}},
               {"probes[0].shape",
                {SceneValue::Map{{"sphere", {SceneValue::Map{{"radius_m", {0.02}}}}}}}},
               {"rates.haptics_hz", {2000.0}},
               {"name", {std::string("8e3")}}}) {
    INFO(path);
    SceneDocument changed = document(folder);
    changed.change(Changes{{path, value}});
    const Scene read = parse_scene(resolved_text(changed.scene()), folder.path() / "scene.yaml");
    CHECK(resolved_text(read) == resolved_text(changed.scene()));
    CHECK(resolved_text(read) != resolved_text(document(folder).scene()));
  }
  SceneDocument changed = document(folder);
  changed.change(Changes{{"organs[0].tissue.youngs_modulus_pa", {8e3}}});
  CHECK(changed.scene().organs[0].tissue.youngs_modulus == 8e3);
  CHECK(number(changed, "organs[0].tissue.youngs_modulus_pa") == 8e3);
  changed.change(Changes{{"organs[0].tissue", {}}});
  CHECK(changed.scene().organs[0].tissue.youngs_modulus == Tissue().youngs_modulus);
}

TEST_CASE(
    "scene document: every key of a scene has a value, and setting it to that changes nothing") {
  // Oracle: the full scene's resolved text; its keys are walked from the values themselves.
  const SceneFolder folder;
  SceneDocument full = document(folder, kFullScene);
  const std::string before = resolved_text(full.scene());
  std::size_t set = 0;
  const std::function<void(const std::string&)> walk = [&](const std::string& path) {
    const SceneValue value = full.value(path);
    if (const auto* map = std::get_if<SceneValue::Map>(&value.content)) {
      for (const auto& entry : *map) walk(path.empty() ? entry.first : path + "." + entry.first);
    }
    const auto* list = std::get_if<SceneValue::List>(&value.content);
    for (std::size_t i = 0; list != nullptr && i < list->size(); ++i) {
      if (std::holds_alternative<SceneValue::Map>((*list)[i].content)) {
        walk(path + "[" + std::to_string(i) + "]");
      }
    }
    if (path.empty()) return;
    INFO(path);
    full.change(Changes{{path, value}});
    CHECK(resolved_text(full.scene()) == before);
    ++set;
  };
  walk("");
  CHECK(set > 100);
}

TEST_CASE("scene document: a refusal names file, line and key, and changes nothing") {
  // Oracle: the lines of the text, counted by hand.
  const SceneFolder folder;
  SceneDocument scene = document(folder,
                                 "palpate_scene: 1\n"
                                 "organs:\n"
                                 "  - mesh: {file: organ.ply}\n"
                                 "    tissue:\n"
                                 "      youngs_modulus_pa: 5e3\n"
                                 "probes:\n"
                                 "  - shape: {sphere: {radius_m: 0.01}}\n"
                                 "    device: {topic: {start_m: [0, 0, 1]}}\n");
  using Place = std::pair<int, std::string>;
  const std::string e = "organs[0].tissue.youngs_modulus_pa";
  CHECK(refused(scene, {{e, {-3.0}}}) == Place(5, e));
  CHECK(refused(scene, {{e, {std::string("8e3")}}}) == Place(5, e));
  CHECK(refused(scene, {{e, {std::numeric_limits<double>::quiet_NaN()}}}) == Place(5, e));
  CHECK(refused(scene, {{e, {std::numeric_limits<double>::infinity()}}}) == Place(5, e));
  CHECK(refused(scene, {{"organs[0].tissue.drag_per_s", {-1.0}}}) ==
        Place(4, "organs[0].tissue.drag_per_s"));
  CHECK(refused(scene, {{"organs[0].tisue", {1.0}}}) == Place(3, "organs[0].tisue"));
  CHECK(refused(scene, {{"probes[0].shape", {}}}) == Place(7, "probes[0].shape"));
  CHECK(refused(scene, {{e, {8e3}}, {"organs[0].model", {std::string("jelly")}}}) ==
        Place(3, "organs[0].model"));
  for (const char* path :
       {"", ".", "a..b", "a[", "a[b]", "a[-1]", "[0]", "organs[9]", "organs[9].name",
        "organs[1234567].name", "organs.name", "organs[0]name"}) {
    INFO(path);
    CHECK(refused(scene, {{path, {1.0}}}).first == 0);
  }
  CHECK(refused(scene, {{"name.first", {1.0}}}).second == "name");
  CHECK(refused(scene, {{"a]", {1.0}}}).second == "a]");
}

TEST_CASE("scene document: entries are added behind the last and taken out") {
  // Oracle: definition.
  const SceneFolder folder;
  SceneDocument scene = document(folder);
  const std::size_t probes = scene.scene().probes.size();
  const std::string next = "probes[" + std::to_string(probes) + "]";
  const SceneValue radius{SceneValue::Map{{"radius_m", {0.01}}}};
  const SceneValue start{SceneValue::Map{{"start_m", {SceneValue::List{{0.0}, {0.0}, {1.0}}}}}};
  scene.change(Changes{{next,
                        {SceneValue::Map{{"name", {std::string("other")}},
                                         {"shape", {SceneValue::Map{{"sphere", radius}}}},
                                         {"device", {SceneValue::Map{{"topic", start}}}}}}}});
  REQUIRE(scene.scene().probes.size() == probes + 1);
  CHECK(scene.scene().probes[probes].name == "other");
  scene.change(Changes{{next + ".friction", {0.7}}});
  CHECK(scene.scene().probes[probes].friction == 0.7);
  scene.change(Changes{{"probes[0]", {}}});
  REQUIRE(scene.scene().probes.size() == probes);
  CHECK(scene.scene().probes[probes - 1].friction == 0.7);
}

TEST_CASE("scene document: places that share a node by an anchor change one by one") {
  // Oracle: definition.
  const SceneFolder folder;
  SceneDocument scene =
      document(folder,
               "palpate_scene: 1\n"
               "organs:\n"
               "  - {name: a, mesh: {file: organ.ply}, tissue: &t {drag_per_s: 3}}\n"
               "  - {name: b, mesh: {file: organ.ply}, tissue: *t}\n"
               "probes:\n"
               "  - shape: {sphere: {radius_m: 0.01}}\n"
               "    device: {topic: {start_m: [0, 0, 1]}}\n");
  scene.change(Changes{{"organs[0].tissue.drag_per_s", {5.0}}});
  CHECK(scene.scene().organs[0].tissue.drag == 5);
  CHECK(scene.scene().organs[1].tissue.drag == 3);
}

}  // namespace
}  // namespace palpate::scene::test
