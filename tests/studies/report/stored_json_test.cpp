#include "studies/report/stored_json.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <sstream>

#include "tests/scratch_folder.h"
#include "tests/studies/damages.h"

namespace palpate::report {
namespace {

TEST_CASE("stored json: numbers come back with the same bits, also those that are not finite") {
  // Oracle: what was stored.
  const ScratchFolder folder;
  std::ostringstream log;
  const PointFiles file(folder.path(), log);
  const double infinite = std::numeric_limits<double>::infinity();
  const std::vector<double> numbers{0.1, 1.0 / 3, -4.9e-324, 1.7976931348623157e308, -infinite};
  Json::Value result;
  for (const double number : numbers) result["numbers"].append(number);
  result["none"] = std::nan("");
  store_json(file, "point.json", "scene 1", result);
  const auto back = stored_json(file, "point.json", "scene 1");
  REQUIRE(back);
  for (Json::ArrayIndex i = 0; i < numbers.size(); ++i) {
    CHECK((*back)["numbers"][i].asDouble() == numbers[i]);
  }
  CHECK(std::isnan((*back)["none"].asDouble()));
}

TEST_CASE("stored json: of other inputs, damaged or absent, it is as if there was none") {
  // Oracle: definition.
  const ScratchFolder folder;
  std::ostringstream log;
  const PointFiles file(folder.path(), log);
  CHECK_FALSE(stored_json(file, "point.json", "scene 1"));
  store_json(file, "point.json", "scene 1", Json::Value(Json::objectValue));
  CHECK(stored_json(file, "point.json", "scene 1"));
  CHECK_FALSE(stored_json(file, "point.json", "scene 2"));
  CHECK(log.str().empty());
  const std::string whole = text_in(folder / "point.json");
  std::vector<std::string> texts = damaged(whole);
  for (const char* text : {"{", "[1, 2]", "7", "{\"of\": 3}", "null"}) texts.emplace_back(text);
  for (const std::string& text : texts) {
    INFO(text);
    folder.write("point.json", text);
    CHECK_FALSE(stored_json(file, "point.json", "scene 1"));
  }
  CHECK_THAT(log.str(), Catch::Contains("point.json: was "));
  for (const char* text :
       {"{\n", "[1, 2]\n", "7\n", "{\"of\": 3}\n", "null\n"}) {  // sealed, others
    INFO(text);
    file.write("point.json", text);
    CHECK_FALSE(stored_json(file, "point.json", "scene 1"));
  }
}

}  // namespace
}  // namespace palpate::report
