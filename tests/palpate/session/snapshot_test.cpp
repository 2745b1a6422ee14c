// Sessions that go on from a snapshot.
#include <algorithm>
#include <catch2/catch.hpp>
#include <random>

#include "modules/core/error.h"
#include "modules/scene/scene_file.h"
#include "modules/scene/scene_reader.h"
#include "tests/palpate/ball_scene.h"
#include "tests/palpate/session/continued.h"

namespace palpate::session {
namespace {

using testing::continued;
using testing::first_difference;

/// A ball that a finger presses and slides over.
constexpr const char* kPress =
    "scripted: {start_m: [0, 0, 0.065], moves: [{to_m: [0.01, 0, 0.045], duration_s: 0.3}]}";

/// When each shipped scene's probes press [s].
double pressed_at(const std::string& scene) {
  if (scene == "stomach_probe_refined") return 2.6;
  return scene.starts_with("liver_") ? 3.6 : 3.0;
}

TEST_CASE("snapshot: every shipped scene goes on from it with the bytes of one never interrupted") {
  // Oracle: the same session without interruption, every sample of every topic.
  std::size_t touched = 0, scenes = 0;
  for (const auto& shipped : scene::shipped_scenes()) {
    INFO(shipped.name);
    const scene::Scene scene = scene::load_scene(scene::scene_file(shipped.name));
    const double at = pressed_at(shipped.name);
    const auto both = continued(scene, load_assets(scene), at, at + 0.15);
    CHECK(both.whole.size() > 100);
    CHECK(first_difference(both) == "");
    touched += both.force > 0 ? 1 : 0;
    ++scenes;
  }
  CHECK(touched + 1 == scenes);  // one waits for a hand
}

TEST_CASE("snapshot: a mesh that follows is taken up again, also while the next one is told") {
  // Oracle: the same session without interruption; every advance of a slide that changes meshes.
  const scene::Scene scene = scene::load_scene(scene::scene_file("liver_touch"));
  std::vector<double> times;
  for (int k = 0; k < 12; ++k) times.push_back(5.45 + 0.01 * k);
  std::size_t surfaces = 0;
  for (const auto& both : continued(scene, load_assets(scene), times, 5.65)) {
    INFO(both.whole.size());
    CHECK(first_difference(both) == "");
    surfaces += static_cast<std::size_t>(std::ranges::count_if(
        both.whole, [](const auto& said) { return said.first == "surface"; }));
  }
  CHECK(surfaces > 0);
}

TEST_CASE("snapshot: rates that do not divide each other, at any instant, and again from there") {
  // Oracle: the same session without interruption.
  const palpate::testing::BallScene files(kPress,
                                          "rates: {collision_hz: 300, deformation_hz: 70}\n");
  const scene::Scene scene = scene::load_scene(files.file());
  const Assets assets = load_assets(scene);
  std::mt19937 random(3);
  for (int k = 0; k < 12; ++k) {
    const double at = std::uniform_real_distribution(0.05, 0.3)(random);
    INFO(at);
    const auto both = continued(scene, assets, at, at + 0.1);
    CHECK(both.force > 0);
    CHECK(first_difference(both) == "");
  }
}

TEST_CASE("snapshot: a session that went on gives the snapshot of one never interrupted") {
  // Oracle: the bytes of the other's snapshot: nothing that is remembered differs.
  const palpate::testing::BallScene files(kPress);
  const scene::Scene scene = scene::load_scene(files.file());
  const Assets assets = load_assets(scene);
  InProcess whole(scene, assets);
  whole.run_until(0.2);
  const runtime::Snapshot first = whole.snapshot();
  whole.run_until(0.3);
  InProcessOptions options;
  options.from = &first;
  InProcess rest(scene, assets, options);
  CHECK(rest.snapshot().modules == first.modules);
  rest.run_until(0.3);
  CHECK(rest.snapshot().modules == whole.snapshot().modules);
}

TEST_CASE("snapshot: a state that is cut or too long under a right CRC is refused, too") {
  // Oracle: the state as it was is taken.
  const palpate::testing::BallScene files(kPress);
  const scene::Scene scene = scene::load_scene(files.file());
  const Assets assets = load_assets(scene);
  InProcess session(scene, assets);
  session.run_until(0.25);
  const runtime::Snapshot good = session.snapshot();
  std::mt19937 random(9);
  for (int k = 0; k < 120; ++k) {
    runtime::Snapshot bad = good;
    auto& state = std::next(bad.modules.begin(), k % 3)->second;
    if (k % 2 == 0) {
      state.resize(random() % state.size());
    } else {
      state.push_back(0);
    }
    InProcessOptions options;
    options.from = &bad;
    CHECK_THROWS_AS(InProcess(scene, assets, options), InputError);
  }
}

}  // namespace
}  // namespace palpate::session
