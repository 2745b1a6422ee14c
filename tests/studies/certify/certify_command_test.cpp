#include "studies/certify/certify_command.h"

#include <catch2/catch.hpp>
#include <fstream>
#include <sstream>

#include "modules/core/error.h"
#include "studies/certify/tables.h"
#include "studies/report/progress.h"
#include "studies/report/reference_table.h"
#include "tests/scratch_folder.h"
#include "tests/studies/certify/subjects.h"

using namespace palpate;
using namespace palpate::testing;
using namespace palpate::certify;

namespace {

CertifyOptions options_for(const BallScene& scene, const char* folder) {
  CertifyOptions options;
  options.scene = scene.file();
  options.out = scene.folder() / folder;
  options.lockstep = options.quick = true;
  return options;
}

}  // namespace

TEST_CASE("certify command: in lockstep it writes a certificate and its tables") {
  // Oracle: the promise of docs/certify.md; that its bytes are the same each time shows the next.
  const BallScene scene(kFingerFromAbove);
  std::ostringstream out, log;
  const auto go_on = [] { return false; };
  const int code = run_certify(options_for(scene, "one"), go_on, out, log);
  const std::string one = text_in(scene.folder() / "one/certificate.json");
  CHECK((one.find("\"verdict\" : \"fail\"") != std::string::npos) == (code == kExitFailed));
  CHECK(one.find("\"complete\" : true") != std::string::npos);
  for (const char* table : {"law.csv", "force.csv", "press.csv", "held.csv", "slide.csv"}) {
    INFO(table);
    CHECK(report::ReferenceTable(scene.folder() / "one" / table).size() > 2);
  }
  CHECK(std::filesystem::exists(scene.folder() / "one/certificate.html"));
}

TEST_CASE("certify command: shards in one folder make the certificate of one machine") {
  // Oracle: the same bytes without shards; a plain run afterwards measures nothing.
  const BallScene scene(kFingerFromAbove);
  std::ostringstream out, log, told, nothing;
  const auto go_on = [] { return false; };
  auto options = options_for(scene, "alone");
  const int code = run_certify(options, go_on, out, log);
  options = options_for(scene, "shared");
  for (const std::size_t index : {2u, 1u}) {
    options.shard = report::Shard{index, 2};
    CHECK(run_certify(options, go_on, told, log) == kExitDone);
    CHECK_FALSE(std::filesystem::exists(scene.folder() / "shared/certificate.json"));
  }
  CHECK_THAT(told.str(), Catch::Contains("shard 1/2: 0 points measured here"));
  options.shard.reset();
  CHECK(run_certify(options, go_on, out, nothing) == code);
  CHECK(nothing.str().find("law …") == std::string::npos);
  CHECK(text_in(scene.folder() / "shared/certificate.json") ==
        text_in(scene.folder() / "alone/certificate.json"));
  options.shard = report::Shard{1, 2};
  options.lockstep = false;
  CHECK_THROWS_WITH(run_certify(options, go_on, out, log), Catch::Contains("needs --lockstep"));
}

TEST_CASE("certify command: stopped, it leaves what is done, marked incomplete") {
  // Oracle: the promise of docs/certify.md.
  const BallScene scene(kFingerFromAbove);
  std::ostringstream out, log;
  const auto soon = [&] { return out.str().find("force: ") != std::string::npos; };
  CHECK(run_certify(options_for(scene, "cut"), soon, out, log) == kExitStopped);
  const std::string json = text_in(scene.folder() / "cut/certificate.json");
  CHECK(json.find("\"complete\" : false") != std::string::npos);
  CHECK(json.find("\"group\" : \"law\"") != std::string::npos);
  CHECK(json.find("\"group\" : \"sliding\"") == std::string::npos);
}

TEST_CASE("certify command: one part alone, pushed as hard as it is told") {
  // Oracle: the groups that are written; at rest the hand's force is the organ's, in the mean.
  const BallScene scene(kFingerFromAbove);
  auto options = options_for(scene, "part");
  options.only = {"held"};
  options.push = 0.04;
  std::filesystem::create_directory(scene.folder() / "part");
  std::ofstream(scene.folder() / "part/certify_law.png") << "of an earlier run";
  std::ofstream(scene.folder() / "part/law.csv") << "depth_m,law_n_per_m,organ_n_per_m\n1,1,1\n";
  std::ostringstream out, log;
  run_certify(
      options, [] { return false; }, out, log);
  const std::string json = text_in(scene.folder() / "part/certificate.json");
  CHECK(json.find("\"group\" : \"stability\"") != std::string::npos);
  for (const char* other : {"law", "force", "energy", "steps", "sliding", "link: 20 ms late"}) {
    CHECK(json.find("\"group\" : \"" + std::string(other) + '"') == std::string::npos);
  }
  const std::string page = text_in(scene.folder() / "part/certificate.html");
  CHECK(page.find("certify_law") == std::string::npos);
  const report::ReferenceTable held(scene.folder() / "part/held.csv");
  double sum = 0;
  for (std::size_t i = held.size() - 1000; i < held.size(); ++i) sum += held.at("force_n", i);
  CHECK(sum / 1000 == Approx(options.push).epsilon(0.02));
}

TEST_CASE("certify command: its page says which lines each part has") {
  // Oracle: the parts that --only takes.
  const std::string page = text_in(std::filesystem::path(PALPATE_SOURCE_DIR) / "docs/certify.md");
  for (const std::string& part : kParts) {
    INFO(part);
    CHECK(page.find("\n| `" + part + "` | ") != std::string::npos);
  }
}

TEST_CASE("certify command: a scene that is none is bad input") {
  // Oracle: the error families.
  CertifyOptions options;
  options.scene = "/nowhere.yaml";
  std::ostringstream out, log;
  CHECK_THROWS_AS(run_certify(
                      options, [] { return false; }, out, log),
                  InputError);
}

TEST_CASE("certify command: what needs the real processes is not certified in lockstep") {
  // Oracle: definition; it would be a certificate of nothing.
  const BallScene scene(kFingerFromAbove);
  for (const char* part : {"timing", "released", "beside"}) {
    auto options = options_for(scene, "nothing");
    options.lockstep = true;
    options.only = {"held", part};
    std::ostringstream out, log;
    CHECK_THROWS_AS(run_certify(
                        options, [] { return false; }, out, log),
                    InputError);
  }
}

TEST_CASE("certify tables: columns name their unit") {
  // Oracle: what is read back.
  const BallScene scene;
  write_law({{1e-3, 90, 100}}, scene.folder());
  const report::ReferenceTable table(scene.folder() / "law.csv");
  CHECK(table.at("depth_m", 0) == 1e-3);
  CHECK(table.at("organ_n_per_m", 0) == 100);
}
