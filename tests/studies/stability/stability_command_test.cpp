#include "studies/stability/stability_command.h"

#include <catch2/catch.hpp>
#include <fstream>
#include <map>
#include <sstream>

#include "modules/core/error.h"
#include "tests/studies/chart/folders.h"

namespace palpate::stability {
namespace {

StabilityOptions quick_in(const std::filesystem::path& out) {
  StabilityOptions options;
  options.out = out;
  options.quick = true;
  return options;
}

std::string text_of(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

StabilityOptions one_series_in(const std::filesystem::path& folder) {
  StabilityOptions options = quick_in(folder);
  options.only_maps = {"step_stiffness"};
  options.only_series = {"implicit_volume"};
  return options;
}

TEST_CASE("stability command: tables and maps appear, and a second run finds the same") {
  // Oracle: the promised files, theory met, and bit-equal tables of a run that measures nothing.
  const chart::testing::WorkFolder folder;
  const StabilityOptions options = one_series_in(folder.path);
  std::ostringstream out, again, log;
  REQUIRE(run_stability(options, out, log) == kExitDone);
  CHECK_THAT(out.str(), Catch::Contains("implicit_volume") && Catch::Contains("3 of 3 frontiers"));
  CHECK(std::filesystem::exists(folder.path / "stability_step_stiffness.png"));
  const std::string tries = text_of(folder.path / "atlas.csv");
  const std::string frontiers = text_of(folder.path / "frontiers.csv");
  CHECK_THAT(tries, Catch::Contains("stable") && Catch::Contains("diverged"));
  const auto measured = std::filesystem::last_write_time(
      std::filesystem::directory_iterator(folder.path / "points")->path());
  REQUIRE(run_stability(options, again, log) == kExitDone);
  CHECK(text_of(folder.path / "atlas.csv") == tries);
  CHECK(text_of(folder.path / "frontiers.csv") == frontiers);
  CHECK(std::filesystem::last_write_time(
            std::filesystem::directory_iterator(folder.path / "points")->path()) == measured);
}

TEST_CASE("stability command: damaged points are named and measured again, tables stay the same") {
  // Oracle: the run before the damage, whose three points are cut at a line, have another digit
  // and lack their seal.
  const chart::testing::WorkFolder folder;
  const StabilityOptions options = one_series_in(folder.path);
  std::ostringstream out, log, again;
  REQUIRE(run_stability(options, out, log) == kExitDone);
  const std::string tries = text_of(folder.path / "atlas.csv");
  std::map<std::filesystem::path, std::string> points;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path / "points")) {
    if (entry.is_regular_file()) points[entry.path()] = text_of(entry.path());
  }
  REQUIRE(points.size() == 3);
  int which = 0;
  for (const auto& [file, whole] : points) {
    const std::size_t line = whole.find('\n', whole.size() / 2) + 1;
    std::string text = which == 1 ? whole : whole.substr(0, which == 0 ? line : whole.find('#'));
    if (which++ == 1) text[line] = text[line] == '1' ? '2' : '1';
    std::ofstream(file) << text;
  }
  REQUIRE(run_stability(options, again, log) == kExitDone);
  CHECK(text_of(folder.path / "atlas.csv") == tries);
  CHECK(again.str() == out.str());
  for (const auto& [file, whole] : points) {
    CHECK_THAT(log.str(), Catch::Contains(file.string() + ": was "));
    CHECK(text_of(file) == whole);
  }
}

TEST_CASE("stability command: shards in one folder make the tables of one machine, byte for byte") {
  // Oracle: a run without shards. No clock is in the atlas.
  const chart::testing::WorkFolder alone, shared;
  StabilityOptions options = quick_in(alone.path);
  options.only_maps = {"step_stiffness"};
  options.only_series = {"implicit_volume", "mass_spring"};
  std::ostringstream out, log;
  REQUIRE(run_stability(options, out, log) == kExitDone);
  options.out = shared.path;
  for (const std::size_t index : {2u, 1u}) {
    options.shard = report::Shard{index, 2};
    std::ostringstream told;
    REQUIRE(run_stability(options, told, log) == kExitDone);
    CHECK_THAT(told.str(), Catch::StartsWith("shard " + std::to_string(index) + "/2: "));
    CHECK_FALSE(std::filesystem::exists(shared.path / "atlas.csv"));
  }
  options.shard.reset();
  std::ostringstream merged, nothing;
  REQUIRE(run_stability(options, merged, nothing) == kExitDone);
  CHECK(nothing.str().empty());  // nothing was left to measure
  for (const char* table : {"atlas.csv", "frontiers.csv"}) {
    CHECK(text_of(shared.path / table) == text_of(alone.path / table));
    CHECK_FALSE(text_of(shared.path / table).empty());
  }
}

TEST_CASE("stability command: unknown maps and series are refused with what there is") {
  // Oracle: the messages.
  const chart::testing::WorkFolder folder;
  StabilityOptions options = quick_in(folder.path);
  std::ostringstream out, log;
  options.only_maps = {"weather"};
  CHECK_THROWS_WITH(run_stability(options, out, log),
                    "map 'weather': must be one of step_stiffness, squeeze, probe_speed, "
                    "mesh_quality, haptic_loop, locking");
  options.only_maps = {"haptic_loop"};
  options.only_series = {"jelly"};
  CHECK_THROWS_WITH(run_stability(options, out, log),
                    Catch::Contains("series 'jelly': must be one of force_1000Hz"));
}

}  // namespace
}  // namespace palpate::stability
