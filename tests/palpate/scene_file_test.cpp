#include "palpate/scene_file.h"

#include <catch2/catch.hpp>

using namespace palpate::launcher;

TEST_CASE("scene file: a file goes before a name, what is neither stays as it was said") {
  // Oracle: definition.
  CHECK(scene_file("/nowhere/x.yaml") == "/nowhere/x.yaml");
  CHECK(scene_file("no_such_scene") == "no_such_scene");
  CHECK(scene_file("").empty());
}
