#include "modules/runtime/snapshot.h"

#include <sys/stat.h>
#include <catch2/catch.hpp>
#include <random>

#include "modules/core/crc32.h"
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

/// What is said of a name to write to; "" if it is taken.
std::string name_refusal(const std::filesystem::path& file, bool overwrite) {
  try {
    check_snapshot_name(file, overwrite);
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

TEST_CASE("snapshot: its time is that of the next cycle of a module that remembers") {
  // Oracle: by hand; periods of 3 ms, 5 ms and 7 ms, and pictures, which remember nothing.
  scene::Scene scene;
  scene.rates = {1e3 / 3, 200, 1e3 / 7, 1e3};
  constexpr std::int64_t kMs = 1'000'000;
  CHECK(snapshot_time(scene, 0) == 0);
  CHECK(snapshot_time(scene, 1) == 3 * kMs);
  CHECK(snapshot_time(scene, 3 * kMs + 1) == 5 * kMs);
  CHECK(snapshot_time(scene, 6 * kMs + 1) == 7 * kMs);
  CHECK(snapshot_time(scene, 7 * kMs + 1) == 9 * kMs);
}

TEST_CASE("snapshot: nothing but a snapshot is replaced by one, and that only if asked") {
  // Oracle: the definition.
  const scene::Scene scene = scene::load_scene(scene::scene_file("ball_squeeze"));
  const ScratchFolder folder;
  write_snapshot(folder / "old", scene, {});
  CHECK(name_refusal(folder / "old", true) == "");
  CHECK(name_refusal(folder / "old", false).find("is there already") != std::string::npos);
  CHECK(name_refusal(folder / "new", false) == "");
  const auto text = folder.write("text", "palpate snaps");
  std::filesystem::create_symlink(folder / "nowhere", folder / "link");
  std::filesystem::create_symlink(folder / "old", folder / "linked");
  // A link to one is followed, and stays; one to nothing is refused.
  CHECK(name_refusal(folder / "link", false).find("cannot be written") != std::string::npos);
  CHECK(name_refusal(folder / "linked", true) == "");
  CHECK(name_refusal(folder / "linked", false).find("or --overwrite") != std::string::npos);
  write_snapshot(folder / "linked", scene, {.time_ns = 7});
  CHECK(std::filesystem::is_symlink(folder / "linked"));
  CHECK(read_snapshot(folder / "old", scene).time_ns == 7);
  std::filesystem::create_symlink(text, folder / "to_text");
  for (const std::filesystem::path& kept :
       {text, folder / "to_text", folder.path(), std::filesystem::path("/dev/full")}) {
    INFO(kept.string());
    CHECK(name_refusal(kept, true).find("is no snapshot, and is not replaced") !=
          std::string::npos);
  }
  CHECK(name_refusal("/proc/x", false).find("/proc takes no file") != std::string::npos);
  CHECK(name_refusal(folder / "no/new", true).find("there is no folder") != std::string::npos);
  CHECK(name_refusal(folder / std::string(300, 'n'), true).find("too long") != std::string::npos);
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
  CHECK(refusal(folder / "nowhere", scene).find("no such file") != std::string::npos);
  CHECK(refusal(folder.path(), scene).find("is a folder") != std::string::npos);
  REQUIRE(::mkfifo((folder / "fifo").c_str(), 0600) == 0);  // to read it would be to wait
  CHECK(refusal(folder / "fifo", scene).find("is a FIFO") != std::string::npos);

  // Whatever the number is, and none, as the first form had it; the CRC of each is right.
  for (const char* number : {" 1", " 3", "", " 99999999999999999999999", "\n", " 2 "}) {
    std::string line = "palpate snapshot" + std::string(number) + "\n";
    const std::string other = line + bytes.substr(bytes.find('\n') + 1, bytes.size());
    const std::string_view all(other.data(), other.size() - 4);
    const std::uint32_t crc =
        crc32({reinterpret_cast<const std::uint8_t*>(all.data()), all.size()});
    std::string with_crc(all);
    with_crc.append(reinterpret_cast<const char*>(&crc), sizeof crc);
    INFO(line);
    CHECK(refusal(folder.write("format", with_crc), scene).find("this program takes format 2") !=
          std::string::npos);
  }

  const scene::Scene other =
      scene::load_scene_with(shipped, {"organs[0].tissue.youngs_modulus_pa=8e3"});
  CHECK(refusal(file, other).find("of scene 'ball_squeeze'") != std::string::npos);
}

TEST_CASE("snapshot: a scene of the same content under another name takes it") {
  // Oracle: the bytes of the scene's file, copied.
  const auto shipped = scene::scene_file("ball_squeeze");
  const ScratchFolder folder;
  write_snapshot(folder / "at.snapshot", scene::load_scene(shipped), Snapshot{100'000'000});
  std::filesystem::create_directory(folder / "meshes");
  std::filesystem::copy_file(shipped.parent_path() / "meshes/ball.ply", folder / "meshes/ball.ply");
  const auto copy = folder.write("another.yaml", text_in(shipped));
  CHECK(refusal(folder / "at.snapshot", scene::load_scene(copy)) == "");
}

}  // namespace
}  // namespace palpate::runtime
