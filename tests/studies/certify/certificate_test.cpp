#include "studies/certify/certificate.h"

#include <json/json.h>

#include <catch2/catch.hpp>
#include <fstream>
#include <limits>
#include <sstream>

#include "tests/scratch_folder.h"
#include "tests/studies/certify/subjects.h"

using namespace palpate;
using namespace palpate::testing;
using namespace palpate::certify;

TEST_CASE("certificate: JSON holds each line's number, limit, source and verdict") {
  // Oracle: JsonCpp reads what was written.
  const BallScene scene(kFingerFromAbove);
  const Subject subject = load_subject(scene.file(), kGoOn);
  Certificate certificate;
  certificate.complete = true;
  certificate.lines = {at_most("g", {"a <b>", 0.25, 1, "N", "a page", "a note"}),
                       at_most("g", {"b", std::numeric_limits<double>::infinity(), 1, "N", "", ""}),
                       not_measured("h", "c", "why")};
  write_json(certificate, subject, scene.folder());
  Json::Value json;
  std::istringstream(text_in(scene.folder() / "certificate.json")) >> json;
  CHECK(json["verdict"] == "fail");
  CHECK(json["complete"] == true);
  CHECK(json["scene"] == "press");
  REQUIRE(json["lines"].size() == 3);
  CHECK(json["lines"][0]["value"] == 0.25);
  CHECK(json["lines"][0]["sense"] == "at most");
  CHECK(json["lines"][0]["source"] == "a page");
  CHECK(json["lines"][1]["value"].isNull());
  CHECK(json["lines"][1]["verdict"] == "fail");
  CHECK(json["lines"][2]["verdict"] == "not measured");
  CHECK(json["lines"][2]["note"] == "why");

  std::ofstream(scene.folder() / "certify_law.png") << "picture";
  write_page(certificate, subject, scene.folder());
  const std::string page = text_in(scene.folder() / "certificate.html");
  CHECK(page.find("a &lt;b&gt;") != std::string::npos);
  CHECK(page.find("src=\"certify_law.png\"") != std::string::npos);
  CHECK(page.find("<h2>h</h2>") != std::string::npos);
}

TEST_CASE("certificate: what is incomplete does not pass") {
  // Oracle: definition.
  Certificate certificate;
  certificate.lines = {at_most("g", {"a", 0, 1, "", "", ""})};
  CHECK_FALSE(certificate.passed());
  certificate.complete = true;
  CHECK(certificate.passed());
}
