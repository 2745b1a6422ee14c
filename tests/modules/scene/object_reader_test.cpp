#include "modules/scene/object_reader.h"

#include <vector>

#include "tests/modules/scene/scene_text.h"

using namespace palpate;
using namespace palpate::scene;
using namespace palpate::scene::test;

namespace {}  // namespace

TEST_CASE("object reader: an unknown key is refused with the nearest and all allowed ones") {
  // Oracle: the nearest key by eye, at each depth of the scene.
  CHECK(refusal("drag_per_s: 3", "drag: 3") ==
        "scene.yaml:13: key 'organs[0].tissue.drag' is not known; did you mean 'drag_per_s'? "
        "Allowed: youngs_modulus_pa, wall_thickness_m, density_kg_per_m3, damping_ratio, "
        "drag_per_s");
  CHECK(refusal("unit: mm", "units: mm") ==
        "scene.yaml:5: key 'organs[0].mesh.units' is not known; did you mean 'unit'? Allowed: "
        "file, unit, nodes");
  CHECK(refusal("rates: {", "rate: {") ==
        "scene.yaml:86: key 'rate' is not known; did you mean 'rates'? Allowed: palpate_scene, "
        "name, organs, probes, contacts, gravity_m_per_s2, duration_s, rates, "
        "deformation_threads, haptics, needs, camera");
  CHECK(refusal("capsule: {", "cylinder: {") ==
        "scene.yaml:47: key 'probes[1].shape.cylinder' is not known. "
        "Allowed: sphere, capsule, box, cone, grasper, plane, mesh");
  CHECK(refusal("plane: {}", "plane: {z_m: 0}") ==
        "scene.yaml:58: key 'probes[3].shape.plane.z_m' is not known. None is allowed here");
  CHECK(refusal("name: full", "<<: {name: full}").substr(0, 45) ==
        "scene.yaml:2: key '<<' is not known. Allowed:");
}

TEST_CASE("object reader: a key that is no word is refused") {
  // Oracle: the message promised.
  CHECK_THAT(refusal("name: full", "\"a\\nb\": full"),
             Catch::StartsWith("scene.yaml:2: key 'a b' is not known. Allowed: "));
  CHECK(refusal("name: full", "[1, 2]: full") == "scene.yaml:2: a key of '' is not a plain word");
}

TEST_CASE("object reader: a key given twice is refused at the second") {
  // Oracle: line numbers of the changed text.
  CHECK(refusal("name: full", "name: full\nname: empty") ==
        "scene.yaml:3: key 'name' is given twice");
  CHECK(refusal("damping_ratio: 0.2", "youngs_modulus_pa: 1e4") ==
        "scene.yaml:12: key 'organs[0].tissue.youngs_modulus_pa' is given twice");
}

TEST_CASE("object reader: every required key is missed") {
  // Oracle: the list of required keys in docs/scene.md, taken away one by one.
  const SceneFolder folder;
  CHECK(folder.refusal("palpate_scene: 1\n") == "scene.yaml:1: key 'organs' is missing");
  CHECK(folder.refusal("palpate_scene: 1\norgans: []\n") ==
        "scene.yaml:1: key 'probes' is missing");
  CHECK(refusal("  - name: liver\n    mesh: {file: organ.ply}\n", "  - name: liver\n") ==
        "scene.yaml:33: key 'organs[1].mesh' is missing");
  CHECK(refusal("{file: tool.stl, unit: cm, nodes: 100}", "{unit: cm}") ==
        "scene.yaml:61: key 'probes[4].shape.mesh.file' is missing");
  CHECK(refusal("    shape: {plane: {}}\n", "") ==
        "scene.yaml:57: key 'probes[3].shape' is missing");
  CHECK(refusal("    device: {topic: {start_m: [0, 0, 0.4]}}\n", "") ==
        "scene.yaml:60: key 'probes[4].device' is missing");
  CHECK(refusal("{start_m: [0, 0, 0.4]}", "{}") ==
        "scene.yaml:62: key 'probes[4].device.topic.start_m' is missing");
  CHECK(refusal("        start_m: [0, 0, 0.2]\n", "") ==
        "scene.yaml:40: key 'probes[0].device.scripted.start_m' is missing");
  CHECK(refusal("        file: press.csv,\n", "") ==
        "scene.yaml:49: key 'probes[1].device.trajectory.file' is missing");
  CHECK(refusal("center_m: [0.01, 0.02, 0.03], ", "") ==
        "scene.yaml:29: key 'organs[0].fixed[0].sphere.center_m' is missing");
  CHECK(refusal("          max_m: [1, 2, 3]\n", "") ==
        "scene.yaml:30: key 'organs[0].fixed[1].box.max_m' is missing");
  CHECK(refusal("          min_m: [-1, -2, -3]\n", "") ==
        "scene.yaml:30: key 'organs[0].fixed[1].box.min_m' is missing");
}

TEST_CASE("object reader: where keys must be, nothing else is taken") {
  // Oracle: the messages promised.
  CHECK(refusal("{plane: {}}", "plane") ==
        "scene.yaml:58: key 'probes[3].shape' = 'plane': must hold keys, out of: sphere, capsule, "
        "box, cone, grasper, plane, mesh");
  CHECK(refusal("plane: {}", "plane: 1") ==
        "scene.yaml:58: key 'probes[3].shape.plane' = '1': must be {}");
  CHECK(refusal("{file: tool.stl, unit: cm, nodes: 100}", "tool.stl") ==
        "scene.yaml:61: key 'probes[4].shape.mesh' = 'tool.stl': must hold keys, out of: file, "
        "unit, nodes");
  CHECK(refusal("{position_m: [0, -1, 0], target_m: [0, 0, 0.1]}", "") ==
        "scene.yaml:93: key 'camera' = 'null': must hold keys, out of: position_m, target_m");
}

TEST_CASE("object reader: a choice is exactly one key") {
  // Oracle: none, and two, of each kind of choice.
  CHECK(refusal("{plane: {}}", "{}") ==
        "scene.yaml:58: key 'probes[3].shape' = '{}': must hold exactly one of: sphere, capsule, "
        "box, cone, grasper, plane, mesh");
  CHECK(refusal("{plane: {}}", "{plane: {}, sphere: {}}") ==
        "scene.yaml:58: key 'probes[3].shape' = '{…}': must hold exactly one of: sphere, capsule, "
        "box, cone, grasper, plane, mesh");
  CHECK(refusal("{topic: {start_m: [0, 0, 0.4]}}", "{}") ==
        "scene.yaml:62: key 'probes[4].device' = '{}': must hold exactly one of: scripted, "
        "trajectory, topic, mouse, emulated");
  CHECK(refusal("- sphere: {center_m: [0.01, 0.02, 0.03], radius_m: 0.04}", "- {}") ==
        "scene.yaml:29: key 'organs[0].fixed[0]' = '{}': must hold exactly one of: sphere, box");
}

TEST_CASE("object reader: lists are lists, and those that are needed are not empty") {
  // Oracle: the messages promised.
  const SceneFolder folder;
  CHECK(folder.refusal("palpate_scene: 1\norgans: {}\nprobes: []\n") ==
        "scene.yaml:2: key 'organs' = '{}': must be a list");
  CHECK(folder.refusal("palpate_scene: 1\norgans: []\nprobes: []\n") ==
        "scene.yaml:2: key 'organs' = '[]': must have at least one entry");
  CHECK(folder.refusal("palpate_scene: 1\norgans:\n - mesh: {file: organ.ply}\nprobes: []\n") ==
        "scene.yaml:4: key 'probes' = '[]': must have at least one entry");
  CHECK(refusal("          - {to_m: [0, 0, 0.1], duration_s: 2.5}\n          - {wait_s: 0.5}\n",
                "          []\n") ==
        "scene.yaml:43: key 'probes[0].device.scripted.moves' = '[]': must have at least one "
        "entry");
  CHECK(refusal("- {wait_s: 0.5}", "- 0.5") ==
        "scene.yaml:45: key 'probes[0].device.scripted.moves[1]' = '0.5': must hold keys, out of: "
        "to_m, duration_s, wait_s");
  CHECK(folder.refusal(changed("{file: organ.ply}\n", "{file: organ.ply}\n    fixed: []\n",
                               kMinimalScene)) == "accepted");
}

TEST_CASE("object reader: there are no more probes than the topics have keys for") {
  // Oracle: the stated limit.
  const SceneFolder folder;
  const auto said_of = [&](std::size_t count) {
    std::string text = "palpate_scene: 1\norgans:\n  - mesh: {file: organ.ply}\nprobes:\n";
    for (std::size_t i = 0; i < count; ++i) {
      text += "  - {shape: {plane: {}}, device: {topic: {start_m: [0, 0, 0]}}}\n";
    }
    return folder.refusal(text);
  };
  CHECK(said_of(kMaxKeys) == "accepted");
  CHECK_THAT(said_of(kMaxKeys + 1),
             Catch::Contains("'probes'") && Catch::Contains("at most 256 entries, has 257"));
}

TEST_CASE("object reader: names are unique among organs and among probes") {
  // Oracle: the second of two equal names is the one refused, also if a default makes it equal.
  CHECK(refusal("name: liver", "name: stomach") ==
        "scene.yaml:33: key 'organs[1].name' = 'stomach': must be unique, but is the name of "
        "organs[0] too");
  CHECK(refusal("name: hand", "name: tip") ==
        "scene.yaml:54: key 'probes[2].name' = 'tip': must be unique, but is the name of "
        "probes[0] too");
  CHECK(refusal("  - name: liver\n    mesh", "  - mesh").substr(0, 8) == "accepted");
  CHECK(refusal("  - name: stomach\n    mesh: {file: organ.ply, unit: mm, nodes: 550}",
                "  - name: organ_1\n    mesh: {file: organ.ply, unit: mm, nodes: 550}") ==
        "accepted");
  CHECK(refusal("name: liver", "name: tip") == "accepted");  // a probe's name
}
