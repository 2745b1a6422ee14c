// What every file keeps to, whatever it includes.
#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>
#include <regex>
#include <set>

#include "tests/structure/source_tree.h"

using namespace palpate::structure;
namespace fs = std::filesystem;

namespace {

std::set<std::string> headers_included_by_tests() {
  std::set<std::string> headers;
  for (const auto& test : sources("tests")) {
    for (const auto& include : includes_of(test)) headers.insert(include.header);
  }
  return headers;
}

/// Bodies of a command that is tested as a whole, and parts of a tested one.
std::set<std::string> tested_elsewhere() {
  return {"modules/bus/input.cpp",         // with every bus: tests/modules/bus/contract_test.cpp
          "modules/bus/output.cpp",        // the same
          "modules/bus/payload_type.cpp",  // the same, and bus_wire_test.cpp
          "modules/messages/message_types.cpp",
          "modules/runtime/lockstep_module.cpp",   // tests/system/lockstep_test.cpp
          "palpate/lockstep_run.cpp",              // the same
          "modules/recording/recorder_stage.cpp",  // the same
          "modules/runtime/run_stage.cpp",         // every module program
          "visualizer/stage.cpp",                  // visualizer_process_test.cpp
          "studies/rigs/touch.cpp",
          "modules/recording/csv_export.cpp",
          "palpate/run_command.cpp",
          "studies/calibration/reference_table.cpp",
          "studies/calibration/squeezed_ball.cpp",
          "studies/chart/accuracy_tables.cpp",
          "studies/chart/point_store.cpp",
          "studies/fuzz/scene_shapes.cpp",
          "bench/bullet/squeezed_ball.cpp",
          "python/python_value.cpp",    // tests/python/scene_test.py
          "python/numbers.cpp",         // tests/python/session_test.py
          "python/errors.cpp",          // the same
          "python/unlocked.cpp",        // the same
          "python/message_arrays.cpp",  // the same
          "python/topic_columns.cpp",   // the same
          "scenes/meshes/level_set.cpp"};
}

/// Itself, or by a header of tests.
bool includes_catch(const std::string& file) {
  const auto headers = includes_of(file);
  return std::ranges::any_of(headers, [](const Include& include) {
    return include.header.starts_with("catch2/") ||
           (include.header.starts_with("tests/") && includes_catch(include.header));
  });
}

bool is_generated(const std::string& file) { return file.find("PubSubTypes") != std::string::npos; }

}  // namespace

TEST_CASE("structure: no generated code is in the tree, and every main is short") {
  // Oracle: the layout rules.
  for (const auto& file : code()) {
    INFO(file);
    CHECK_FALSE(is_generated(file));
    if (!file.ends_with("main.cpp")) continue;
    std::size_t lines = 0;
    for (const auto& line : lines_of(file)) lines += lines > 0 || line.starts_with("int main(");
    CHECK(lines > 0);
    CHECK(lines <= 40);
  }
}

TEST_CASE("structure: what tests checks includes Catch2, not its neighbours in a batch") {
  // Oracle: a build without batches and precompiled headers, as the sanitizers' is, needs it.
  const std::regex checks(R"(\b(CHECK|CHECK_FALSE|CHECK_THAT|REQUIRE|TEST_CASE)\()");
  for (const auto& file : sources("tests")) {
    const auto lines = lines_of(file);
    const bool any = std::ranges::any_of(lines, [&](const std::string& line) {
      return std::regex_search(line, checks) && line.find("//") == std::string::npos;
    });
    INFO(file);
    if (any) CHECK(includes_catch(file));
  }
}

TEST_CASE("structure: every source file has a test beside it in the mirrored tree") {
  // Oracle: the layout rules: the test of a/b.cpp is tests/a/b_test.cpp or .py, or some test
  // includes a/b.h. A source without a header of its own belongs to a tested one.
  std::string missing;
  const auto tested = headers_included_by_tests();
  for (const auto& file : code()) {
    const fs::path path(file);
    if (path.extension() != ".cpp" || is_wiring(file)) continue;
    const std::string header = fs::path(path).replace_extension(".h").string();
    const fs::path folder = "tests" / path.parent_path();
    if (fs::exists(root() / folder / (path.stem().string() + "_test.cpp"))) continue;
    if (fs::exists(root() / folder / (path.stem().string() + "_test.py"))) continue;
    if (!fs::exists(root() / header)) continue;
    if (tested.count(header) > 0 || tested_elsewhere().count(file) > 0) continue;
    missing += file + "\n";
  }
  CHECK(missing == "");
}

TEST_CASE("structure: no file holds the markers of an unfinished merge") {
  // Oracle: git's conflict markers.
  const std::set<std::string> skipped{"build", "out", ".git"};
  std::string found;
  std::size_t checked = 0;
  for (fs::recursive_directory_iterator it(root()), end; it != end; ++it) {
    if (it->is_directory() && skipped.count(it->path().filename().string()) > 0) {
      it.disable_recursion_pending();
    }
    const std::string extension = it->path().extension().string();
    if (!it->is_regular_file() || extension == ".ply" || extension == ".png") continue;
    const std::string file = fs::relative(it->path(), root()).string();
    ++checked;
    for (const auto& line : lines_of(file)) {
      if (line.starts_with(std::string(7, '<') + " ") ||
          line.starts_with(std::string(7, '>') + " ")) {
        found += file + ": " + line + "\n";
      }
    }
  }
  CHECK(found == "");
  CHECK(checked > 500);  // it did read the tree
}
