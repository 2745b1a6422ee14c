#include "modules/runtime/snapshot.h"

#include <catch2/catch.hpp>
#include <random>

#include "modules/core/error.h"
#include "modules/scene/scene_file.h"
#include "modules/scene/scene_reader.h"
#include "modules/scene/settings.h"
#include "tests/scratch_folder.h"

namespace palpate::runtime {
namespace {

/// What reading says; "" if it is taken.
std::string refusal(const std::filesystem::path& file, const scene::Scene& scene) {
  try {
    read_snapshot(file, scene);
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

TEST_CASE("snapshot: one that is torn, damaged, of another scene or no snapshot is refused") {
  // Oracle: what was written; every byte of it counts.
  const auto shipped = scene::scene_file("ball_squeeze");
  const scene::Scene scene = scene::load_scene(shipped);
  const ScratchFolder folder;
  Snapshot snapshot{100'000'000};
  for (const char* module : {"haptics", "deformation"}) {
    for (int k = 0; k < 700; ++k) snapshot.modules[module].push_back(std::uint8_t(k * k));
  }
  const auto file = folder / "at.snapshot";
  write_snapshot(file, scene, snapshot);
  REQUIRE(refusal(file, scene) == "");
  CHECK(read_snapshot(file, scene).time_ns == snapshot.time_ns);
  CHECK(read_snapshot(file, scene).modules == snapshot.modules);
  const std::string bytes = text_in(file);

  std::mt19937 random(5);
  for (int k = 0; k < 2000; ++k) {
    std::string changed = bytes;
    changed[random() % changed.size()] ^= static_cast<char>(1 + random() % 255);
    REQUIRE(refusal(folder.write("changed", changed), scene).find("changed: ") !=
            std::string::npos);
  }
  for (int k = 0; k < 200; ++k) {
    const auto torn = folder.write("torn", bytes.substr(0, random() % bytes.size()));
    REQUIRE(refusal(torn, scene) != "");
  }
  CHECK(refusal(folder.write("longer", bytes + "x"), scene).find("torn or damaged") !=
        std::string::npos);
  CHECK(refusal(folder.write("text", "palpate_scene: 1\n"), scene).find("is no snapshot") !=
        std::string::npos);
  CHECK(refusal(folder / "nowhere", scene).find("cannot be read") != std::string::npos);
  CHECK(refusal(folder.path(), scene).find("cannot be read") != std::string::npos);

  const scene::Scene other =
      scene::load_scene_with(shipped, {"organs[0].tissue.youngs_modulus_pa=8e3"});
  CHECK(refusal(file, other).find("of scene 'ball_squeeze'") != std::string::npos);
}

}  // namespace
}  // namespace palpate::runtime
