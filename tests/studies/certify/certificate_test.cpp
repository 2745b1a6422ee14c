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
  certificate.scope = "in lockstep, only law";
  certificate.lines = {at_most("g", {"a <b>", 0.25, 1, "N", "a page", "a note"}),
                       at_most("g", {"b", std::numeric_limits<double>::infinity(), 1, "N", "", ""}),
                       not_measured("h", "c", "why")};
  write_json(certificate, subject, scene.folder());
  Json::Value json;
  std::istringstream(text_in(scene.folder() / "certificate.json")) >> json;
  CHECK(json["verdict"] == "fail");
  CHECK(json["complete"] == true);
  CHECK(json["scope"] == "in lockstep, only law");
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
  CHECK(page.find("fail</b>, of a part: in lockstep, only law") != std::string::npos);
  CHECK(page.find("a &lt;b&gt;") != std::string::npos);
  CHECK(page.find("src=\"certify_law.png\"") != std::string::npos);
  CHECK(page.find("<h2>h</h2>") != std::string::npos);
}

TEST_CASE("certificate: pictures are of its own tables, an earlier one's are gone") {
  // Oracle: the files in the folder; tables of another certificate lie there, too.
  const BallScene scene;
  for (const char* name : {"certify_law.png", "certify_timing.png", "my.png"}) {
    std::ofstream(scene.folder() / name) << "picture";
  }
  std::ofstream(scene.folder() / "law.csv") << "depth_m,law_n_per_m,organ_n_per_m\n1,1,1\n";
  std::ofstream(scene.folder() / "held.csv") << "time_s,depth_m\n0,1\n1,1\n";
  const auto there = [&](const char* name) {
    return std::filesystem::exists(scene.folder() / name);
  };
  bool drawn = true;
  try {
    draw_pictures({"held"}, scene.folder());
  } catch (const std::runtime_error&) {  // no matplotlib here
    drawn = false;
  }
  CHECK(there("certify_held.png") == drawn);
  CHECK_FALSE(there("certify_law.png"));
  CHECK_FALSE(there("certify_timing.png"));
  CHECK(there("my.png"));
}

TEST_CASE("certificate: what is incomplete does not pass") {
  // Oracle: definition.
  Certificate certificate;
  certificate.lines = {at_most("g", {"a", 0, 1, "", "", ""})};
  CHECK_FALSE(certificate.passed());
  certificate.complete = true;
  CHECK(certificate.passed());
}
