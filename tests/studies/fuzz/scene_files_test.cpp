#include "studies/fuzz/scene_files.h"

#include <catch2/catch.hpp>

#include "modules/scene/scene_reader.h"
#include "tests/studies/chart/folders.h"
#include "tests/studies/fuzz/stores.h"

namespace palpate::fuzz {
namespace {

TEST_CASE("scene files: every random scene is one the reader takes") {
  // Oracle: the strict reader: keys, ranges, files.
  for (std::uint64_t k = 0; k < 40; ++k) {
    CAPTURE(k);
    const chart::testing::WorkFolder folder;
    const RandomScene made = random_scene(7, k);
    const auto file = write_scene(made, testing::shapes(), folder.path);
    scene::Scene read;
    REQUIRE_NOTHROW(read = scene::load_scene(file));
    CHECK(read.organs[0].tissue.youngs_modulus == made.scene.organs[0].tissue.youngs_modulus);
    CHECK(read.probes.size() == made.scene.probes.size());
  }
}

}  // namespace
}  // namespace palpate::fuzz
