#include "studies/report/stored_json.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "tests/scratch_folder.h"

namespace palpate::report {
namespace {

TEST_CASE("stored json: numbers come back with the same bits, also those that are not finite") {
  // Oracle: what was stored.
  const ScratchFolder folder;
  const auto file = folder / "point.json";
  const double infinite = std::numeric_limits<double>::infinity();
  const std::vector<double> numbers{0.1, 1.0 / 3, -4.9e-324, 1.7976931348623157e308, -infinite};
  Json::Value result;
  for (const double number : numbers) result["numbers"].append(number);
  result["none"] = std::nan("");
  store_json(file, "scene 1", result);
  const auto back = stored_json(file, "scene 1");
  REQUIRE(back);
  for (Json::ArrayIndex i = 0; i < numbers.size(); ++i) {
    CHECK((*back)["numbers"][i].asDouble() == numbers[i]);
  }
  CHECK(std::isnan((*back)["none"].asDouble()));
}

TEST_CASE("stored json: of other inputs, damaged or absent, it is as if there was none") {
  // Oracle: definition.
  const ScratchFolder folder;
  const auto file = folder / "point.json";
  CHECK_FALSE(stored_json(file, "scene 1"));
  store_json(file, "scene 1", Json::Value(Json::objectValue));
  CHECK(stored_json(file, "scene 1"));
  CHECK_FALSE(stored_json(file, "scene 2"));
  for (const char* text : {"", "{", "[1, 2]", "7", "{\"of\": 3}", "null"}) {
    INFO(text);
    std::ofstream(file) << text;
    CHECK_FALSE(stored_json(file, "scene 1"));
  }
}

}  // namespace
}  // namespace palpate::report
