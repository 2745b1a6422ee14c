// The borders between the layers, held by reading every #include of the tree.
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

struct Include {
  std::string file, header;
  std::size_t line = 0;
};

const fs::path kRoot = PALPATE_SOURCE_DIR;

/// Source files under `folder` (tree-relative names).
std::vector<std::string> sources(const std::string& folder) {
  std::vector<std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(kRoot / folder)) {
    const auto extension = entry.path().extension();
    if (extension == ".h" || extension == ".cpp") {
      files.push_back(fs::relative(entry.path(), kRoot).string());
    }
  }
  return files;
}

std::vector<Include> includes_of(const std::string& file) {
  static const std::regex kInclude(R"(^\s*#\s*include\s*[<"]([^>"]+)[>"])");
  std::vector<Include> includes;
  std::ifstream stream(kRoot / file);
  std::string line;
  for (std::size_t number = 1; std::getline(stream, line); ++number) {
    std::smatch match;
    if (std::regex_search(line, match, kInclude)) includes.push_back({file, match[1], number});
  }
  return includes;
}

/// "modules/bus/…" → "bus", "deformation/…" → "deformation", except "deformation/elements/…" →
/// "elements"; empty for foreign headers.
std::string layer_of(const std::string& path) {
  static const std::regex kLayer(
      R"(^(?:modules/([a-z]+)|(deformation|collision|haptics|visualizer))/)");
  std::smatch match;
  if (path.rfind("deformation/elements/", 0) == 0) return "elements";
  if (!std::regex_search(path, match, kLayer)) return "";
  return match[1].matched ? match[1] : match[2];
}

bool is_process_file(const std::string& file) {
  return file.ends_with("_process.h") || file.ends_with("_process.cpp") ||
         file.ends_with("/main.cpp");
}

void report(const Include& include, const std::string& why) {
  UNSCOPED_INFO(include.file << ":" << include.line << ": includes " << include.header << ": "
                             << why);
}

TEST_CASE("structure: libraries include only the layers below them") {
  // Oracle: the layer picture in docs/pipeline.md. Process files wire everything and are exempt.
  const std::map<std::string, std::set<std::string>> allowed{
      {"core", {}},
      {"geometry", {"core"}},
      {"scene", {"core", "geometry"}},
      {"deformation", {"core", "geometry", "scene", "elements"}},
      {"elements", {"core", "geometry"}},
      {"collision", {"core", "geometry", "scene"}},
      {"haptics", {"core", "geometry", "scene"}},
      {"pipeline", {"core", "geometry", "scene", "deformation", "collision", "haptics"}},
      {"bus", {"core"}},
      {"runtime", {"core", "geometry", "scene", "bus"}},
      {"recording", {"core", "scene", "bus", "runtime", "geometry"}},
      {"visualizer", {"core", "geometry", "scene", "bus", "runtime"}}};
  std::size_t checked = 0, violations = 0;
  for (const auto& [layer, below] : allowed) {
    const std::string folder = fs::exists(kRoot / "modules" / layer) ? "modules/" + layer
                               : layer == "elements"                 ? "deformation/elements"
                                                                     : layer;
    for (const auto& file : sources(folder)) {
      if (is_process_file(file) || layer_of(file) != layer) continue;
      for (const auto& include : includes_of(file)) {
        ++checked;
        const std::string target = layer_of(include.header);
        if (target.empty() || target == layer || below.count(target) > 0) continue;
        report(include, layer + " may not know " + target);
        ++violations;
      }
    }
  }
  CHECK(violations == 0);
  CHECK(checked > 300);  // it did read the tree
}

TEST_CASE("structure: each foreign library is known to its one folder only") {
  // Oracle: the dependency rules; tests may include what they test against.
  const std::vector<std::pair<std::regex, std::regex>> rules{
      {std::regex("^(fastdds|fastrtps|fastcdr)/"),
       std::regex(
           R"(^modules/(bus|recording)/.*\.cpp$|^modules/bus/(qos|participant|codec|raw).*\.h$)")},
      {std::regex("^fcl/"), std::regex(R"(^collision/.*\.cpp$)")},
      {std::regex("^assimp/"), std::regex(R"(^modules/geometry/.*\.cpp$)")},
      {std::regex("^OpenMesh/"), std::regex(R"(^modules/geometry/.*)")},
      {std::regex("^vtk"), std::regex(R"(^visualizer/.*\.cpp$)")},
      {std::regex("^yaml-cpp/"), std::regex(R"(^modules/scene/.*)")},
      {std::regex("^CLI/"), std::regex(R"(^modules/(runtime|launcher)/.*\.cpp$|main\.cpp$)")},
      {std::regex("^(thread|mutex|condition_variable|chrono|future)$|^(time|signal|pthread)\\.h$"),
       std::regex(
           R"(^(?!deformation|collision|haptics|modules/(core|geometry|scene|pipeline)/).*|.*_process\.cpp$)")}};
  std::size_t violations = 0;
  for (const char* folder : {"modules", "deformation", "collision", "haptics", "visualizer"}) {
    for (const auto& file : sources(folder)) {
      for (const auto& include : includes_of(file)) {
        for (const auto& [header, place] : rules) {
          if (!std::regex_search(include.header, header)) continue;
          if (std::regex_search(file, place)) continue;
          report(include, "not here");
          ++violations;
        }
      }
    }
  }
  CHECK(violations == 0);
}

TEST_CASE("structure: no generated code is in the tree, and every main is short") {
  // Oracle: the layout rules.
  for (const char* folder :
       {"idl", "modules", "deformation", "collision", "haptics", "visualizer"}) {
    for (const auto& file : sources(folder)) {
      INFO(file);
      CHECK(file.find("PubSubTypes") == std::string::npos);
      if (!file.ends_with("main.cpp")) continue;
      std::ifstream stream(kRoot / file);
      std::size_t lines = 0;
      bool in_main = false;
      for (std::string line; std::getline(stream, line);) {
        in_main |= line.rfind("int main(", 0) == 0;
        lines += in_main;
      }
      CHECK(lines > 0);
      CHECK(lines < 40);
    }
  }
}

TEST_CASE("structure: every source file has a test beside it") {
  // Oracle: the layout rules: tests/<part>/<file>_test.cpp, or its name in one of the part's tests.
  const std::set<std::string> wiring{"main.cpp"};
  // Tested through the command they are the body of.
  const std::map<std::string, std::string> elsewhere{
      {"modules/recording/csv_export.cpp", "tests/recording/commands_test.cpp"},
      {"modules/launcher/run_command.cpp", "tests/system/launcher_test.cpp"}};
  std::size_t missing = 0;
  for (const char* folder : {"modules", "deformation", "collision", "haptics", "visualizer"}) {
    for (const auto& file : sources(folder)) {
      const fs::path path(file);
      if (path.extension() != ".cpp" || wiring.count(path.filename()) > 0 ||
          is_process_file(file)) {
        continue;
      }
      const std::string part = layer_of(file);
      if (elsewhere.count(file) > 0 && fs::exists(kRoot / elsewhere.at(file))) continue;
      if (fs::exists(kRoot / "tests" / part / (path.stem().string() + "_test.cpp"))) continue;
      // A header included by some test of the part counts as tested there.
      bool included = false;
      const std::string header = fs::path(file).replace_extension(".h").string();
      for (const auto& test : sources("tests/" + part)) {
        for (const auto& include : includes_of(test)) included |= include.header == header;
      }
      if (included || !fs::exists(kRoot / header)) continue;  // parts of a tested header's class
      UNSCOPED_INFO(file << " has no test");
      ++missing;
    }
  }
  CHECK(missing == 0);
}

}  // namespace
