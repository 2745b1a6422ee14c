#include "modules/scene/scene_reader.h"

#include <random>

#include "tests/modules/scene/scene_text.h"

using namespace palpate;
using namespace palpate::scene;
using namespace palpate::scene::test;

TEST_CASE("scene reader: a minimal scene is one mesh, one shape and one device") {
  // Oracle: the defaults stated in scene.h, written out again here.
  const SceneFolder folder;
  const Scene scene = folder.parse(kMinimalScene);
  CHECK(scene.file == folder.path() / "scene.yaml");
  CHECK(scene.name == "scene");
  REQUIRE(scene.organs.size() == 1);
  const Organ& organ = scene.organs[0];
  CHECK(organ.name == "organ_0");
  CHECK(organ.mesh.file == folder.path() / "organ.ply");
  CHECK(organ.mesh.unit == "m");
  CHECK(organ.mesh.nodes == 0);
  CHECK(organ.pose.position == Vec3::Zero());
  CHECK(organ.pose.rotation.coeffs() == Quat::Identity().coeffs());
  CHECK(organ.tissue.youngs_modulus == 10e3);
  CHECK(organ.tissue.wall_thickness == 3e-3);
  CHECK(organ.tissue.density == 1058);
  CHECK(organ.springs.virtual_nodes == 6);
  CHECK(organ.model == "implicit_volume");
  CHECK(organ.volume_corrections == 0);
  CHECK(organ.integrator == Integrator::kAutomatic);
  CHECK(organ.filling.points.empty());
  CHECK(organ.filling.breathing_amplitude == 0);
  CHECK(organ.fixed.empty());
  REQUIRE(scene.probes.size() == 1);
  const Probe& probe = scene.probes[0];
  CHECK(probe.name == "probe_0");
  CHECK(std::get<SphereShape>(probe.shape).radius == 0.006);
  CHECK(probe.friction == 0.1);
  CHECK(std::get<TopicDevice>(probe.device).start == Vec3(0, 0, 0.1));
  CHECK(scene.gravity == Vec3::Zero());
  CHECK(scene.duration == 0);
  CHECK(scene.rates.haptics == 1000);
  CHECK(scene.rates.collision == 250);
  CHECK(scene.rates.deformation == 250);
  CHECK(scene.rates.visualizer == 30);
  CHECK(scene.haptics.max_force == 3.3);
  CHECK(scene.deformation_threads == 1);
  CHECK_FALSE(scene.camera.position);
  CHECK_FALSE(scene.camera.target);
}

TEST_CASE("scene reader: every key of an organ arrives in its field") {
  // Oracle: the numbers of the full scene's text.
  const SceneFolder folder;
  const Scene scene = folder.parse(kFullScene);
  REQUIRE(scene.organs.size() == 2);
  const Organ& organ = scene.organs[0];
  CHECK(organ.name == "stomach");
  CHECK(scene.organs[1].name == "liver");
  CHECK(organ.mesh.file == folder.path() / "organ.ply");
  CHECK(organ.mesh.unit == "mm");
  CHECK(organ.mesh.nodes == 550);
  CHECK(organ.pose.position == Vec3(0.1, 0.2, 0.3));
  CHECK(organ.pose.rotation.z() == Approx(0.6));
  CHECK(organ.pose.rotation.w() == Approx(0.8));
  CHECK(organ.tissue.youngs_modulus == 20e3);
  CHECK(organ.tissue.wall_thickness == 0.004);
  CHECK(organ.tissue.density == 1000);
  CHECK(organ.tissue.damping_ratio == 0.2);
  CHECK(organ.tissue.drag == 3);
  CHECK(organ.springs.bending_ratio == 0.4);
  CHECK(organ.springs.inner_ratio == 0.7);
  CHECK(organ.springs.virtual_nodes == 5);
  CHECK(organ.model == "implicit_volume");
  CHECK(organ.volume_corrections == 2);
  CHECK(organ.integrator == Integrator::kBackwardEuler);
  REQUIRE(organ.filling.points.size() == 2);
  CHECK(organ.filling.points[1].time == 5);
  CHECK(organ.filling.points[1].ratio == 1.25);
  CHECK(organ.filling.breathing_amplitude == 0.1);
  CHECK(organ.filling.breathing_rate == 0.4);
  CHECK(organ.filling.max_rate == 0.7);
  REQUIRE(organ.fixed.size() == 2);
  CHECK(std::get<SphereRegion>(organ.fixed[0]).center == Vec3(0.01, 0.02, 0.03));
  CHECK(std::get<SphereRegion>(organ.fixed[0]).radius == 0.04);
  CHECK(std::get<BoxRegion>(organ.fixed[1]).min == Vec3(-1, -2, -3));
  CHECK(std::get<BoxRegion>(organ.fixed[1]).max == Vec3(1, 2, 3));
}

TEST_CASE("scene reader: every key of a probe arrives in its field") {
  // Oracle: the numbers of the full scene's text.
  const SceneFolder folder;
  const auto probes = folder.parse(kFullScene).probes;
  REQUIRE(probes.size() == 6);
  CHECK(probes[0].name == "tip");
  CHECK(probes[0].friction == 0.3);
  CHECK(std::get<SphereShape>(probes[0].shape).radius == 0.007);
  const auto& scripted = std::get<ScriptedDevice>(probes[0].device);
  CHECK(scripted.start == Vec3(0, 0, 0.2));
  CHECK(scripted.rotation.x() == 1);
  REQUIRE(scripted.moves.size() == 2);
  REQUIRE(scripted.moves[0].to);
  CHECK(*scripted.moves[0].to == Vec3(0, 0, 0.1));
  CHECK(scripted.moves[0].duration == 2.5);
  CHECK_FALSE(scripted.moves[1].to);
  CHECK(scripted.moves[1].duration == 0.5);
  CHECK(std::get<CapsuleShape>(probes[1].shape).radius == 0.003);
  CHECK(std::get<CapsuleShape>(probes[1].shape).length == 0.2);
  const auto& trajectory = std::get<TrajectoryDevice>(probes[1].device);
  CHECK(trajectory.file == folder.path() / "press.csv");
  CHECK(trajectory.offset.position == Vec3(0.4, 0.5, 0.6));
  CHECK(trajectory.offset.rotation.y() == 1);
  CHECK(trajectory.loop);
  CHECK(std::get<BoxShape>(probes[2].shape).size == Vec3(0.01, 0.02, 0.03));
  CHECK(std::get<TopicDevice>(probes[2].device).rotation.z() == 1);
  CHECK(std::holds_alternative<PlaneShape>(probes[3].shape));
  const Mesh& mesh = std::get<MeshShape>(probes[4].shape).mesh;
  CHECK(mesh.file == folder.path() / "tool.stl");
  CHECK(mesh.unit == "cm");
  CHECK(mesh.nodes == 100);
  const auto& emulated = std::get<EmulatedDevice>(probes[5].device);
  CHECK(emulated.kind == EmulatedDevice::Kind::kOmega);
  CHECK(emulated.start == Vec3(0, 0, 0.5));
  CHECK(emulated.axis == Vec3(0, 0.6, 0.8));
  CHECK(emulated.mass == 0.3);
  CHECK(emulated.encoder_step == 1e-6);
  CHECK(emulated.rate == 4000);
  CHECK(emulated.transport_delay == 5e-4);
  CHECK(emulated.hand.stiffness == 150);
  CHECK(emulated.hand.push == Vec3(0, 0, -0.15));
  REQUIRE(emulated.hand.moves.size() == 2);
  CHECK(emulated.hand.moves[0].duration == 2);
}

TEST_CASE("scene reader: every key of the scene itself arrives in its field") {
  // Oracle: the numbers of the full scene's text.
  const SceneFolder folder;
  const Scene scene = folder.parse(kFullScene);
  CHECK(scene.name == "full");
  CHECK(scene.gravity == Vec3(0, 0, -9.81));
  CHECK(scene.duration == 20);
  CHECK(scene.rates.haptics == 2000);
  CHECK(scene.rates.collision == 500);
  CHECK(scene.rates.deformation == 400);
  CHECK(scene.rates.visualizer == 60);
  CHECK(scene.haptics.max_force == 5);
  CHECK(scene.haptics.max_force_rate == 300);
  CHECK(scene.haptics.device_damping == 0.4);
  CHECK(scene.haptics.stale_after == 0.06);
  CHECK(scene.haptics.fade_time == 0.07);
  CHECK(scene.deformation_threads == 3);
  CHECK_FALSE(scene.contacts.any());
  CHECK(scene.contacts.friction == 0.25);
  REQUIRE(scene.camera.position);
  CHECK(*scene.camera.position == Vec3(0, -1, 0));
  REQUIRE(scene.camera.target);
  CHECK(*scene.camera.target == Vec3(0, 0, 0.1));
}

TEST_CASE("scene reader: text that is no YAML is refused at its line") {
  // Oracle: the line where the text was broken by hand.
  const SceneFolder folder;
  for (const std::string quote : {"'", "\""}) {
    CHECK_THAT(folder.refusal(changed("name: stomach", "name: " + quote + "stomach")),
               Catch::StartsWith("scene.yaml:") &&
                   Catch::EndsWith(": not valid YAML: a quoted text is not closed"));
  }
  CHECK_THAT(folder.refusal(changed("    tissue:", "\t\ttissue:")),
             Catch::StartsWith("scene.yaml:8: not valid YAML: "));
  CHECK_THAT(folder.refusal(changed("[0.1, 0.2, 0.3]", "[0.1, 0.2, 0.3")),
             Catch::StartsWith("scene.yaml:7: not valid YAML: "));
  CHECK_THAT(folder.refusal(changed("name: full", "name: *unknown_alias")),
             Catch::StartsWith("scene.yaml:2: not valid YAML: "));
  for (const auto& mark :
       {std::string("\xFF\xFE"), std::string("\xFE\xFF"), std::string("\0\0\xFE\xFF", 4)}) {
    CHECK_THAT(folder.refusal(mark + kFullScene),
               Catch::Equals("scene.yaml:1: is UTF-16 or UTF-32; save it as UTF-8"));
  }
  for (const char* bracket : {"[", "{"}) {
    std::string deep;
    for (int k = 0; k < 20'000; ++k) deep += bracket;
    CHECK_THAT(folder.refusal(deep), Catch::StartsWith("scene.yaml:") &&
                                         Catch::EndsWith(": not valid YAML: nested too deep"));
  }
}

TEST_CASE("scene reader: a mesh of fewer nodes than a closed surface has is refused at its line") {
  // Oracle: a tetrahedron's four.
  const SceneFolder folder;
  for (const char* nodes : {"nodes: 1", "nodes: 3"}) {
    CHECK_THAT(folder.refusal(changed("nodes: 550", nodes)),
               Catch::StartsWith("scene.yaml:5: key 'organs[0].mesh.nodes'") &&
                   Catch::Contains("must be 0, or 4 at least"));
  }
}

TEST_CASE("scene reader: a file that is no scene is refused in one line") {
  // Oracle: the messages promised for each kind of file.
  const SceneFolder folder;
  CHECK(folder.refusal("") == "scene.yaml:1: the scene is empty");
  CHECK(folder.refusal("# only a remark\n") == "scene.yaml:1: the scene is empty");
  CHECK(folder.refusal("just words") ==
        "scene.yaml:1: the scene: must be a mapping that begins with palpate_scene: 1");
  CHECK(folder.refusal("{}") ==
        "scene.yaml:1: the scene: must be a mapping that begins with palpate_scene: 1");
  CHECK(folder.refusal("[1, 2]") ==
        "scene.yaml:1: the scene: must be a mapping that begins with palpate_scene: 1");
  CHECK(folder.refusal(kMinimalScene + "---\n" + kMinimalScene) ==
        "scene.yaml: holds more than one YAML document ('---' or '...')");
  CHECK(folder.refusal(kMinimalScene + "#" + std::string(1 << 20, '-')) ==
        "scene.yaml: longer than a scene may be (1048576 bytes)");
}

TEST_CASE("scene reader: an anchor stands for what it names") {
  // Oracle: the same text written out twice.
  const SceneFolder folder;
  const Scene scene = folder.parse(changed("wall_thickness_m: 0.004", "wall_thickness_m: &t 0.02",
                                           changed("radius_m: 0.007", "radius_m: *t")));
  CHECK(std::get<SphereShape>(scene.probes[0].shape).radius == 0.02);
  CHECK(folder.refusal(changed("name: full", "name: &loop [*loop]")) ==
        "scene.yaml:2: key 'name' = '[…]': must be a text");
}

TEST_CASE("scene reader: a damaged scene is refused in one line, or is a scene") {
  // Oracle: invariant over 5000 seeded edits: nothing but an InputError that begins with the file's
  // name and is one line; what is accepted can be written and read again.
  const SceneFolder folder;
  std::mt19937 random(1);
  const std::string signs = " \n\t:-[]{},'\"#&*!|>%@`?~0.eE/\\\x01\xff";
  const auto below = [&](std::size_t count) { return random() % count; };
  int refused = 0;
  for (int i = 0; i < 5000; ++i) {
    std::string text = kFullScene;
    for (std::size_t edits = 1 + below(3); edits > 0; --edits) {
      const std::size_t at = below(text.size());
      switch (below(3)) {
        case 0:
          text.erase(at, 1 + below(20));
          break;
        case 1:
          text.insert(at, 1, signs[below(signs.size())]);
          break;
        default:
          text[at] = signs[below(signs.size())];
      }
    }
    const std::string message = folder.refusal(text);
    if (message == "accepted") {
      if (folder.refusal(resolved_text(folder.parse(text))) != "accepted") FAIL(text);
    } else {
      ++refused;
      const bool is_one_line = message.find('\n') == std::string::npos;
      if (!message.starts_with("scene.yaml:") || !is_one_line) FAIL(message << "\n" << text);
    }
  }
  CHECK(refused > 2500);
}

TEST_CASE("scene reader: the format comes first and is one that is known") {
  // Oracle: the rule in docs/scene.md.
  const SceneFolder folder;
  CHECK(folder.refusal("\nname: a\n" + kMinimalScene) ==
        "scene.yaml:2: the first key must be palpate_scene: 1");
  CHECK(folder.refusal(changed("palpate_scene: 1", "palpate_scene: 2")) ==
        "scene.yaml:1: key 'palpate_scene' = '2': must be 1");
  CHECK(folder.refusal("palpate_scene: 2\n") ==
        "scene.yaml:1: key 'palpate_scene' = '2': must be 1");  // before what is missing
  CHECK(folder.refusal(changed("palpate_scene: 1", "palpate_scene: one")) ==
        "scene.yaml:1: key 'palpate_scene' = 'one': must be a whole number");
}

TEST_CASE("scene reader: a scene is loaded from its file, and files are found beside it") {
  // Oracle: the same text parsed directly.
  const SceneFolder folder;
  const auto file =
      folder.write("sub/press.yaml", changed("organ.ply", "../organ.ply", kMinimalScene));
  const Scene scene = load_scene(file);
  CHECK(scene.name == "press");
  CHECK(scene.file == file);
  CHECK(scene.organs[0].mesh.file == folder.path() / "organ.ply");
}

TEST_CASE("scene reader: an absolute file name is taken as it is") {
  // Oracle: the path given.
  const SceneFolder folder;
  const ScratchFolder elsewhere;
  const auto mesh = elsewhere.write("other.ply", "");
  const Scene scene = folder.parse(changed("organ.ply", mesh.string(), kMinimalScene));
  CHECK(scene.organs[0].mesh.file == mesh);
}

TEST_CASE("scene reader: scene files that cannot be read are named") {
  // Oracle: the file system.
  const SceneFolder folder;
  const std::string name = folder.path().string();
  CHECK_THROWS_MATCHES(load_scene(folder.path() / "none.yaml"), InputError,
                       Catch::Message(name + "/none.yaml: no such file"));
  CHECK_THROWS_MATCHES(load_scene(folder.path()), InputError,
                       Catch::Message(name + ": is a folder, not a file"));
  const auto locked = folder.write("locked.yaml", kMinimalScene);
  std::filesystem::permissions(locked, std::filesystem::perms::none);
  const AsNobody nobody;
  CHECK_THROWS_MATCHES(load_scene(locked), InputError,
                       Catch::Message(locked.string() + ": may not be read"));
}

TEST_CASE("scene reader: a scene whose file name is no acceptable name needs one") {
  // Oracle: the rule for names.
  const SceneFolder folder;
  CHECK_THROWS_MATCHES(parse_scene(kMinimalScene, folder.path() / "a\nb.yaml"), InputError,
                       Catch::Predicate<InputError>([](const InputError& error) {
                         return std::string(error.what()).find("key 'name'") != std::string::npos;
                       }));
}

TEST_CASE("scene reader: an emulated device is read by itself, in a driven probe's place") {
  // Oracle: what is written; the messages.
  const TopicDevice place{Vec3(0.1, 0.2, 0.3), Quat(0, 1, 0, 0)};
  const EmulatedDevice plain = parse_emulated_device("", "--device", place);
  CHECK(plain.start == place.start);
  CHECK(plain.rotation.coeffs() == place.rotation.coeffs());
  CHECK(plain.kind == EmulatedDevice::Kind::kTouch);
  const EmulatedDevice given = parse_emulated_device(
      "{start_m: [1, 2, 3], axis: [0, 0, 1], hand: {mass_kg: 2}}", "--device", place);
  CHECK(given.start == Vec3(1, 2, 3));
  CHECK(given.axis == Vec3(0, 0, 1));
  CHECK(given.hand.mass == 2);
  CHECK_THROWS_WITH(parse_emulated_device("{kind: omega, mass: 3}", "--device", place),
                    Catch::StartsWith("--device:1: key 'mass' is not known"));
  CHECK_THROWS_WITH(parse_emulated_device("[1]", "--device", place),
                    Catch::StartsWith("--device:1: "));
  CHECK_THROWS_WITH(parse_emulated_device("{axis: [0, 0, 0]}", "--device", place),
                    Catch::Contains("axis must be a direction"));
}
