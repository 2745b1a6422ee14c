#include "studies/chart/sweep.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <set>
#include <sstream>

#include "modules/scene/models.h"
#include "tests/scratch_folder.h"
#include "tests/studies/chart/folders.h"
#include "tests/studies/damages.h"
#include "tests/studies/keep_on.h"

namespace palpate::chart {
namespace {

using report::kKeepOn;

TEST_CASE("sweep: what was measured is not measured again and comes back the same") {
  // Oracle: a second sweep that is stopped at the first measurement finishes all the same.
  const testing::WorkFolder folder;
  std::ostringstream log;
  const PointStore store(folder.path / "points", log);
  report::Claims claims(folder.path / "claims", {});
  const std::vector<Case> of{find_case("ball")};
  const std::vector<std::string> models{"mass_spring"};
  const auto begin = [](const Outlook&) {};
  const auto first = sweep(of, Extent::kQuick, models, store, claims, begin, kKeepOn).points;
  REQUIRE(first.size() == 1);
  struct Stop {};
  const auto again =
      sweep(of, Extent::kQuick, models, store, claims, begin, [] { throw Stop{}; }).points;
  REQUIRE(again.size() == 1);
  const auto &a = first[0].measurement, &b = again[0].measurement;
  CHECK(a.surface_nodes == b.surface_nodes);
  REQUIRE(a.samples.size() == b.samples.size());
  for (std::size_t i = 0; i < a.samples.size(); ++i) {
    CHECK(b.samples[i].force == a.samples[i].force);
    CHECK(std::isnan(b.samples[i].field_error));
  }
}

TEST_CASE("sweep: a stored point that is not whole is named, and is as if it was not there") {
  // Oracle: definition.
  const ScratchFolder folder;
  std::ostringstream ignored;
  const Case of = find_case("ball");
  Measurement measured, back;
  measured.samples.resize(2);
  measured.samples[1].force = 0.125;
  PointStore(folder.path(), ignored).write(of, "key", measured);
  const auto file = std::filesystem::directory_iterator(folder.path())->path().filename().string();
  REQUIRE(PointStore(folder.path(), ignored).read(of, "key", back));
  CHECK(back.samples.at(1).force == 0.125);
  for (const std::string& text : damaged(text_in(folder / file))) {
    INFO(text);
    folder.write(file, text);
    std::ostringstream log;
    CHECK_FALSE(PointStore(folder.path(), log).read(of, "key", back));
    CHECK_THAT(log.str(), Catch::Contains(file + ": was "));
  }
}

TEST_CASE("sweep: quick is less than usual, usual less than full") {
  // Oracle: the extents' meaning; iterations are swept where a model has them, and only there.
  for (const Case& of : cases()) {
    const auto quick = settings_of(of, Extent::kQuick), usual = settings_of(of, Extent::kUsual);
    CHECK(quick.size() < usual.size());
    CHECK(usual.size() < settings_of(of, Extent::kFull).size());
    std::set<std::string> keys;
    for (const Setting& setting : usual) {
      CHECK(keys.insert(setting.key()).second);
      CHECK((setting.iterations == 0 || scene::format_of(setting.model).iterations > 0));
    }
  }
  const auto ball = settings_of(find_case("ball"), Extent::kUsual);
  const auto iterating = std::ranges::count_if(
      scene::model_formats(), [](const scene::ModelFormat& each) { return each.iterations > 0; });
  CHECK(std::ranges::count_if(ball, [](const Setting& each) { return each.iterations > 0; }) ==
        3 * iterating);
}

TEST_CASE("sweep: what it says is left shrinks to nothing as points are done") {
  // Oracle: a second run has nothing left to say; numbers of jobs count up.
  const testing::WorkFolder folder;
  std::ostringstream log;
  const PointStore store(folder.path / "points", log);
  report::Claims claims(folder.path / "claims", {});
  const std::vector<std::string> models{"mass_spring", "implicit_volume"};
  std::vector<Outlook> said;
  const auto say = [&](const Outlook& outlook) { said.push_back(outlook); };
  sweep({find_case("vibration")}, Extent::kQuick, models, store, claims, say, kKeepOn);
  REQUIRE(said.size() == 2);
  CHECK(std::isnan(said[0].seconds_left));
  CHECK(said[1].seconds_left > 0);
  CHECK(said[1].done == 1);
  CHECK(said[1].total == 2);
  sweep({find_case("vibration")}, Extent::kQuick, models, store, claims, say, kKeepOn);
  CHECK(said.size() == 2);
}

}  // namespace
}  // namespace palpate::chart
