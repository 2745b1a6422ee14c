#include "palpate/list_command.h"

#include <catch2/catch.hpp>
#include <sstream>

#include "modules/core/error.h"
#include "modules/scene/models.h"
#include "modules/scene/scene_file.h"

using namespace palpate;
using namespace palpate::launcher;
using Catch::Contains;

TEST_CASE("list: every model, shape and device has its line, every shipped scene a sentence") {
  // Oracle: the table of models; the words of the schema; the files of the data folder.
  std::ostringstream out;
  CHECK(list_command("", out) == kExitDone);
  for (const auto& model : scene::model_formats()) CHECK_THAT(out.str(), Contains(model.word));
  for (const char* word : {"sphere", "capsule", "plane", "scripted", "mouse", "emulated"}) {
    CHECK_THAT(out.str(), Contains(std::string("\n  ") + word));
  }
  const auto scenes = scene::shipped_scenes();
  REQUIRE(scenes.size() >= 9);
  for (const auto& each : scenes) {
    INFO(each.name);
    CHECK(each.meaning.size() > 20);
    CHECK(each.meaning.ends_with("."));
    CHECK_THAT(out.str(), Contains(each.name));
    CHECK(scene::scene_file(each.name) == each.file);
  }
  std::ostringstream shapes;
  list_command("shapes", shapes);
  CHECK_THAT(shapes.str(), !Contains("stomach_probe"));
}
