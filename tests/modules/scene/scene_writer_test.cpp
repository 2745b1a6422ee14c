#include <cmath>
#include <set>

#include "modules/scene/value_text.h"
#include "tests/modules/scene/scene_text.h"

using namespace palpate;
using namespace palpate::scene;
using namespace palpate::scene::test;

namespace {

void check_same(const Mesh& a, const Mesh& b) {
  CHECK(a.file == b.file);
  CHECK(a.unit == b.unit);
  CHECK(a.nodes == b.nodes);
}

void check_same(const Pose& a, const Pose& b) {
  CHECK(a.position == b.position);
  CHECK(a.rotation.coeffs() == b.rotation.coeffs());
}

void check_same(const Region& a, const Region& b) {
  REQUIRE(a.index() == b.index());
  if (const auto* sphere = std::get_if<SphereRegion>(&a)) {
    CHECK(sphere->center == std::get<SphereRegion>(b).center);
    CHECK(sphere->radius == std::get<SphereRegion>(b).radius);
  } else {
    CHECK(std::get<BoxRegion>(a).min == std::get<BoxRegion>(b).min);
    CHECK(std::get<BoxRegion>(a).max == std::get<BoxRegion>(b).max);
  }
}

void check_same(const Organ& a, const Organ& b) {
  CHECK(a.name == b.name);
  check_same(a.mesh, b.mesh);
  check_same(a.pose, b.pose);
  CHECK(a.tissue.youngs_modulus == b.tissue.youngs_modulus);
  CHECK(a.tissue.wall_thickness == b.tissue.wall_thickness);
  CHECK(a.tissue.density == b.tissue.density);
  CHECK(a.tissue.damping_ratio == b.tissue.damping_ratio);
  CHECK(a.tissue.drag == b.tissue.drag);
  CHECK(a.springs.bending_ratio == b.springs.bending_ratio);
  CHECK(a.springs.inner_ratio == b.springs.inner_ratio);
  CHECK(a.springs.virtual_nodes == b.springs.virtual_nodes);
  CHECK(a.model == b.model);
  CHECK(a.volume_corrections == b.volume_corrections);
  CHECK(a.iterations == b.iterations);
  CHECK(a.integrator == b.integrator);
  REQUIRE(a.filling.points.size() == b.filling.points.size());
  for (std::size_t i = 0; i < a.filling.points.size(); ++i) {
    CHECK(a.filling.points[i].time == b.filling.points[i].time);
    CHECK(a.filling.points[i].ratio == b.filling.points[i].ratio);
  }
  CHECK(a.filling.breathing_amplitude == b.filling.breathing_amplitude);
  CHECK(a.filling.breathing_rate == b.filling.breathing_rate);
  CHECK(a.filling.max_rate == b.filling.max_rate);
  REQUIRE(a.fixed.size() == b.fixed.size());
  for (std::size_t i = 0; i < a.fixed.size(); ++i) check_same(a.fixed[i], b.fixed[i]);
}

void check_same(const ProbeShape& a, const ProbeShape& b) {
  REQUIRE(a.index() == b.index());
  if (const auto* sphere = std::get_if<SphereShape>(&a)) {
    CHECK(sphere->radius == std::get<SphereShape>(b).radius);
  } else if (const auto* capsule = std::get_if<CapsuleShape>(&a)) {
    CHECK(capsule->radius == std::get<CapsuleShape>(b).radius);
    CHECK(capsule->length == std::get<CapsuleShape>(b).length);
  } else if (const auto* box = std::get_if<BoxShape>(&a)) {
    CHECK(box->size == std::get<BoxShape>(b).size);
  } else if (const auto* cone = std::get_if<ConeShape>(&a)) {
    CHECK(cone->radius == std::get<ConeShape>(b).radius);
    CHECK(cone->length == std::get<ConeShape>(b).length);
  } else if (const auto* jaws = std::get_if<GrasperShape>(&a)) {
    const GrasperShape& other = std::get<GrasperShape>(b);
    CHECK(jaws->length == other.length);
    CHECK(jaws->width == other.width);
    CHECK(jaws->thickness == other.thickness);
    CHECK(jaws->opening == other.opening);
  } else if (const auto* mesh = std::get_if<MeshShape>(&a)) {
    check_same(mesh->mesh, std::get<MeshShape>(b).mesh);
  }
}

void check_same(const std::vector<ScriptedDevice::Move>& a,
                const std::vector<ScriptedDevice::Move>& b) {
  REQUIRE(a.size() == b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    CHECK(a[i].to == b[i].to);
    CHECK(a[i].duration == b[i].duration);
  }
}

void check_same(const Device& a, const Device& b) {
  REQUIRE(a.index() == b.index());
  if (const auto* trajectory = std::get_if<TrajectoryDevice>(&a)) {
    CHECK(trajectory->file == std::get<TrajectoryDevice>(b).file);
    check_same(trajectory->offset, std::get<TrajectoryDevice>(b).offset);
    CHECK(trajectory->loop == std::get<TrajectoryDevice>(b).loop);
  } else if (const auto* topic = std::get_if<TopicDevice>(&a)) {
    CHECK(topic->start == std::get<TopicDevice>(b).start);
    CHECK(topic->rotation.coeffs() == std::get<TopicDevice>(b).rotation.coeffs());
  } else if (const auto* mouse = std::get_if<MouseDevice>(&a)) {
    CHECK(mouse->start == std::get<MouseDevice>(b).start);
    CHECK(mouse->rotation.coeffs() == std::get<MouseDevice>(b).rotation.coeffs());
  } else if (const auto* held = std::get_if<EmulatedDevice>(&a)) {
    const auto& two = std::get<EmulatedDevice>(b);
    CHECK(held->kind == two.kind);
    CHECK(held->start == two.start);
    CHECK(held->rotation.coeffs() == two.rotation.coeffs());
    CHECK(held->axis == two.axis);
    CHECK(held->mass == two.mass);
    CHECK(held->damping == two.damping);
    CHECK(held->max_force == two.max_force);
    CHECK(held->encoder_step == two.encoder_step);
    CHECK(held->rate == two.rate);
    CHECK(held->transport_delay == two.transport_delay);
    CHECK(held->hand.mass == two.hand.mass);
    CHECK(held->hand.damping == two.hand.damping);
    CHECK(held->hand.stiffness == two.hand.stiffness);
    CHECK(held->hand.push == two.hand.push);
    check_same(held->hand.moves, two.hand.moves);
  } else {
    const auto &one = std::get<ScriptedDevice>(a), &two = std::get<ScriptedDevice>(b);
    CHECK(one.start == two.start);
    CHECK(one.rotation.coeffs() == two.rotation.coeffs());
    check_same(one.moves, two.moves);
  }
}

void check_same(const Scene& a, const Scene& b) {
  CHECK(a.file == b.file);
  CHECK(a.name == b.name);
  REQUIRE(a.organs.size() == b.organs.size());
  for (std::size_t i = 0; i < a.organs.size(); ++i) check_same(a.organs[i], b.organs[i]);
  REQUIRE(a.probes.size() == b.probes.size());
  for (std::size_t i = 0; i < a.probes.size(); ++i) {
    CHECK(a.probes[i].name == b.probes[i].name);
    check_same(a.probes[i].shape, b.probes[i].shape);
    CHECK(a.probes[i].friction == b.probes[i].friction);
    check_same(a.probes[i].device, b.probes[i].device);
  }
  CHECK(a.gravity == b.gravity);
  CHECK(a.duration == b.duration);
  CHECK(a.rates.haptics == b.rates.haptics);
  CHECK(a.rates.collision == b.rates.collision);
  CHECK(a.rates.deformation == b.rates.deformation);
  CHECK(a.rates.visualizer == b.rates.visualizer);
  CHECK(a.haptics.max_force == b.haptics.max_force);
  CHECK(a.haptics.max_force_rate == b.haptics.max_force_rate);
  CHECK(a.haptics.device_damping == b.haptics.device_damping);
  CHECK(a.haptics.stale_after == b.haptics.stale_after);
  CHECK(a.haptics.fade_time == b.haptics.fade_time);
  CHECK(a.deformation_threads == b.deformation_threads);
  CHECK(a.contacts.organs == b.contacts.organs);
  CHECK(a.contacts.self == b.contacts.self);
  CHECK(a.contacts.friction == b.contacts.friction);
  CHECK(a.camera.position == b.camera.position);
  CHECK(a.camera.target == b.camera.target);
}

}  // namespace

TEST_CASE("resolved text: reads back to the same scene, field by field, bit by bit") {
  // Oracle: the invariant parse ∘ write = identity, on every key and on defaults.
  const SceneFolder folder;
  for (const std::string& text : {kFullScene, kMinimalScene}) {
    const Scene scene = folder.parse(text);
    const Scene again = folder.parse(resolved_text(scene));
    check_same(scene, again);
    CHECK(resolved_text(again) == resolved_text(scene));
  }
}

TEST_CASE("resolved text: awkward numbers and rotations keep every bit") {
  // Oracle: the same invariant with numbers that need 17 digits and quaternions off by 1e-4.
  const SceneFolder folder;
  Scene scene = folder.parse(kMinimalScene);
  scene.organs[0].tissue.youngs_modulus = std::nextafter(10e3, 20e3);
  scene.organs[0].pose.position = Vec3(1.0 / 3, -0.1 + 0.3, 1e-17);
  check_same(scene, folder.parse(resolved_text(scene)));
  for (int i = 1; i < 200; ++i) {
    const double angle = 0.031 * i, size = 1 + 1e-4 * std::sin(i);
    const std::string rotation =
        list_text(Quat(std::cos(angle) * size, std::sin(angle) * size, 0, 0));
    const Scene turned = folder.parse(changed("[0, 0, 0.6, 0.8]", rotation));
    const Scene again = folder.parse(resolved_text(turned));
    INFO(rotation);
    CHECK(turned.organs[0].pose.rotation.coeffs() == again.organs[0].pose.rotation.coeffs());
  }
}

TEST_CASE("resolved text: writes every default out, in the schema's order") {
  // Oracle: the beginning of the text, by hand.
  const SceneFolder folder;
  const std::string text = resolved_text(folder.parse(kMinimalScene));
  CHECK_THAT(text, Catch::StartsWith("palpate_scene: 1\nname: \"scene\"\norgans:\n"
                                     "- name: \"organ_0\"\n  mesh:\n    file: \"" +
                                     (folder.path() / "organ.ply").string() +
                                     "\"\n    unit: \"m\"\n    nodes: 0\n"));
  CHECK_THAT(text, Catch::Contains("  - shape") || Catch::Contains("  shape:\n    sphere:\n"));
  CHECK_THAT(text, Catch::EndsWith("  haptics_hz: 1000\n  cores: 2\ncamera: {}\n"));
}

TEST_CASE("digest: the same scene elsewhere has the same digest") {
  // Oracle: invariance under moving the folder and rewriting the text.
  const SceneFolder here, there;
  const Scene scene = here.parse(kFullScene);
  CHECK(scene_digest(scene) == scene_digest(there.parse(kFullScene)));
  CHECK(scene_digest(scene) == scene_digest(here.parse("# remark\n" + kFullScene)));
  CHECK(scene_digest(scene) == scene_digest(here.parse(resolved_text(scene))));
  CHECK(scene_digest(here.parse(kMinimalScene)) ==
        scene_digest(here.parse(changed("sphere: {}", "sphere: {radius_m: 6e-3}", kMinimalScene))));
}

TEST_CASE("digest: what a scene and its files are called does not count") {
  // Oracle: the same bytes under other names.
  const SceneFolder folder;
  const Scene scene = folder.parse(kFullScene);
  Scene renamed = scene;
  renamed.file.replace_filename("another.yaml");
  renamed.name = "another";
  const std::string digest = scene_digest(scene);
  CHECK(scene_digest(renamed) == digest);
  std::filesystem::rename(folder.path() / "organ.ply", folder.path() / "liver.ply");
  std::string text = kFullScene;
  for (std::size_t at = 0; (at = text.find("organ.ply")) != std::string::npos;) {
    text.replace(at, 9, "liver.ply");
  }
  CHECK(scene_digest(folder.parse(text)) == digest);
}

TEST_CASE("digest: sixteen hexadecimal digits") {
  // Oracle: the format promised.
  const SceneFolder folder;
  const std::string digest = scene_digest(folder.parse(kMinimalScene));
  CHECK(digest.size() == 16);
  CHECK(digest.find_first_not_of("0123456789abcdef") == std::string::npos);
}

TEST_CASE("digest: differs with every number and with every byte of every file") {
  // Oracle: no two of the variants may agree.
  const SceneFolder folder;
  std::set<std::string> digests;
  std::size_t count = 0;
  const auto add = [&](const std::string& text) {
    digests.insert(scene_digest(folder.parse(text)));
    CHECK(digests.size() == ++count);
  };
  add(kFullScene);
  add(changed("20e3", "20000.000001"));
  add(changed("unit: mm", "unit: cm"));
  add(changed("model: implicit_volume\n    volume_corrections: 2", "model: mass_spring"));
  add(changed("plane: {}", "sphere: {}"));
  add(changed("wait_s: 0.5", "wait_s: 0.51"));
  add(changed("visualizer_hz: 60", "visualizer_hz: 61"));
  for (const std::string file : {"organ.ply", "tool.stl", "press.csv"}) {
    std::ofstream(folder.path() / file, std::ios::app) << '\n';
    add(kFullScene);
  }
  folder.write("organ.ply", "An organ\n");
  add(kFullScene);
}

TEST_CASE("digest: a file that has gone since is named") {
  // Oracle: the file system.
  const SceneFolder folder;
  const Scene scene = folder.parse(kFullScene);
  std::filesystem::remove(folder.path() / "tool.stl");
  CHECK_THROWS_MATCHES(scene_digest(scene), InputError,
                       Catch::Message((folder.path() / "tool.stl").string() + ": no such file"));
}
