#include "modules/scene/processes.h"

#include <catch2/catch.hpp>

#include "modules/core/organ_limits.h"
#include "modules/scene/scene_reader.h"
#include "tests/modules/scene/scene_text.h"

namespace palpate::scene {
namespace {

Scene of_processes(const std::vector<std::size_t>& processes) {
  Scene scene;
  for (std::size_t i = 0; i < processes.size(); ++i) {
    scene.organs.emplace_back().name = "organ_" + std::to_string(i);
    scene.organs.back().process = processes[i];
  }
  scene.probes.resize(1);
  return scene;
}

/// Three organs; the second line of each is its process.
std::string text_of(const std::vector<std::string>& processes, const std::string& more = "") {
  std::string text = "palpate_scene: 1\norgans:\n";
  for (const std::string& process : processes) {
    text +=
        "  - mesh: {file: organ.ply}\n" + (process.empty() ? "" : "    process: " + process + "\n");
  }
  return text + "probes:\n  - {shape: {sphere: {}}, device: {topic: {start_m: [0, 0, 1]}}}\n" +
         more;
}

}  // namespace

TEST_CASE("scene processes: each has its organs, and all together have all") {
  // Oracle: the assignment, by hand.
  const Scene scene = of_processes({2, 1, 2});
  CHECK(process_count(scene) == 2);
  CHECK(organs_of(scene, 1) == std::vector<std::size_t>{1});
  CHECK(organs_of(scene, 2) == std::vector<std::size_t>{0, 2});
  CHECK(organs_of(scene, 3).empty());
  const Scene part = part_of(scene, 2);
  REQUIRE(part.organs.size() == 2);
  CHECK(part.organs[1].name == "organ_2");
  CHECK(process_count(in_one_process(scene)) == 1);
  CHECK(process_count(of_processes({1, 1})) == 1);
}

TEST_CASE("scene processes: gaps, organs that may touch apart, and too many laws are refused") {
  // Oracle: the rules in words.
  CHECK(misfit_of_processes(of_processes({1, 2, 3})).none());
  CHECK(misfit_of_processes(of_processes({3, 1, 2})).none());
  CHECK(misfit_of_processes(of_processes({2, 2})).key == "organs[0].process");
  CHECK(misfit_of_processes(of_processes({1, 3})).key == "organs[1].process");
  Scene scene = of_processes({1, 2});
  scene.contacts.self = true;  // each with itself: they may be apart
  CHECK(misfit_of_processes(scene).none());
  scene.contacts.organs = true;
  CHECK(misfit_of_processes(scene).key == "organs[1].process");
  scene.contacts.organs = false;
  scene.probes.resize(kMaxKeys / 2);
  CHECK(misfit_of_processes(scene).none());
  scene.probes.resize(kMaxKeys / 2 + 1);
  CHECK(misfit_of_processes(scene).key == "organs[1].process");
  CHECK(misfit_of_processes(in_one_process(scene)).none());
}

TEST_CASE("scene processes: what cannot be is refused at its line") {
  // Oracle: the line of the key in the text, and the message.
  const test::SceneFolder folder;
  const auto refusal = [&](const std::string& text) {
    const auto file = folder.write("scene.yaml", text);
    try {
      load_scene(file);
    } catch (const InputError& error) {
      const std::string what = error.what();
      return what.substr(what.find("scene.yaml"));
    }
    return std::string("none");
  };
  CHECK(refusal(text_of({"1", "2", "2"})) == "none");
  CHECK(refusal(text_of({"", "3", "1"})) ==
        "scene.yaml:5: key 'organs[1].process' = '3': is 3, but no organ has process 2; they count "
        "up from 1 without a gap");
  CHECK(refusal(text_of({"", "1", "2"}, "contacts: {organs: true}\n")) ==
        "scene.yaml:7: key 'organs[2].process' = '2': must be that of organ 'organ_0', 1: organs "
        "that may touch (contacts.organs) share a process");
  CHECK(refusal(text_of({"17"})).find("scene.yaml:4: key 'organs[0].process' = '17'") == 0);
  CHECK(refusal(text_of({"0"})).find("scene.yaml:4: key 'organs[0].process' = '0'") == 0);
}

}  // namespace palpate::scene
