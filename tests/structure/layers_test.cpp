// The borders between the layers, held by reading every #include of the tree.
#include <catch2/catch.hpp>
#include <functional>
#include <map>
#include <regex>
#include <set>

#include "tests/structure/source_tree.h"

using namespace palpate::structure;

namespace {

using Names = std::set<std::string>;

Names operator+(Names a, const Names& b) {
  a.insert(b.begin(), b.end());
  return a;
}

std::string line_for(const Include& include, const std::string& why) {
  return include.file + ":" + std::to_string(include.line) + ": includes " + include.header + ": " +
         why + "\n";
}

/// What each layer may know beside itself.
std::map<std::string, Names> allowed_layers() {
  const Names scene{"core", "geometry", "scene"};
  const Names runtime = scene + Names{"messages", "bus", "runtime"};
  const Names stages = runtime + Names{"recording", "mcap",    "trajectories", "deformation",
                                       "collision", "haptics", "session"};
  return {{"core", {}},
          {"geometry", {"core"}},
          {"scene", {"core", "geometry"}},
          {"messages", scene},
          {"bus", scene + Names{"messages"}},
          {"runtime", scene + Names{"messages", "bus"}},
          {"mcap", {"core"}},
          {"recording", runtime + Names{"mcap"}},
          {"deformation", scene + Names{"collision"}},
          {"collision", scene},
          {"trajectories", scene + Names{"mcap"}},
          {"haptics", scene + Names{"trajectories"}},
          {"visualizer", runtime},
          {"meshes", {"core", "geometry"}},
          {"session", stages},
          {"palpate", stages + Names{"visualizer"}},
          {"python", stages},
          {"studies", stages + Names{"visualizer", "palpate"}},
          {"bench", stages + Names{"visualizer", "studies"}}};
}

/// Borders that are crossed today: "from > to". To be emptied, never added to.
Names known_crossings() { return {}; }

using Graph = std::map<std::string, std::map<std::string, Include>>;

std::string folder_of(const std::string& path) { return path.substr(0, path.rfind('/')); }

/// Which folder includes from which, with one include as example. Wiring is left out.
Graph folder_graph() {
  Graph graph;
  for (const auto& file : code()) {
    if (is_wiring(file)) continue;
    for (const auto& include : includes_of(file)) {
      if (layer_of(include.header).empty()) continue;
      const std::string from = folder_of(file), to = folder_of(include.header);
      if (from != to) graph[from].emplace(to, include);
    }
  }
  return graph;
}

/// Is `to` reached from `from`?
bool reaches(const Graph& graph, const std::string& from, const std::string& to, Names& seen) {
  if (from == to) return true;
  if (!seen.insert(from).second || graph.count(from) == 0) return false;
  for (const auto& [next, include] : graph.at(from)) {
    if (reaches(graph, next, to, seen)) return true;
  }
  return false;
}

}  // namespace

TEST_CASE("structure: code includes only the layers below it, and never a test header") {
  // Oracle: the order of layers: core, geometry, scene, messages, bus, runtime; physics beside the
  // wire; studies above the product, bench above studies.
  const auto allowed = allowed_layers();
  const auto known = known_crossings();
  std::size_t checked = 0;
  std::string violations;
  for (const auto& file : code()) {
    const std::string layer = layer_of(file);
    INFO(file);
    REQUIRE(allowed.count(layer) == 1);
    for (const auto& include : includes_of(file)) {
      ++checked;
      const std::string target = layer_of(include.header);
      if (target.empty() || target == layer || allowed.at(layer).count(target) > 0) continue;
      if (target != "tests" && is_wiring(file)) continue;
      if (known.count(layer + " > " + target) > 0) continue;
      violations += line_for(include, layer + " may not know " + target);
    }
  }
  CHECK(violations == "");
  CHECK(checked > 1000);  // it did read the tree
}

TEST_CASE("structure: no folder reaches itself through another") {
  // Oracle: the layout rules.
  const Graph graph = folder_graph();
  CHECK(graph.size() > 20);  // it did read the tree
  std::string cycles;
  for (const auto& [from, targets] : graph) {
    for (const auto& [to, include] : targets) {
      Names seen;
      if (reaches(graph, to, from, seen))
        cycles += line_for(include, to + " leads back to " + from);
    }
  }
  CHECK(cycles == "");
}

TEST_CASE("structure: each foreign library is known to its one folder only") {
  // Oracle: the dependency rules; tests may include what they test against.
  struct Rule {
    std::string header, place;
  };
  const std::string no_physics =
      "^(?!deformation/|collision/|haptics/|modules/(core|geometry|scene|messages)/)";
  const std::vector<Rule> rules{
      {"^(fastdds|fastrtps|fastcdr|idl)/",
       R"(^modules/(bus|recording)/.*\.cpp$|^modules/bus/(qos|participant|payload_type|codec_fields|raw).*\.h$)"},
      {"^fcl/", "^bench/"},
      {"^assimp/|^OpenMesh/", "^modules/geometry/"},
      {"^vtk", R"(^visualizer/.*\.cpp$)"},
      {"^Bullet|^btBullet", "^bench/bullet/"},
      {"^yaml-cpp/", "^modules/scene/"},
      {"^(pybind11/|Python\\.h)", "^python/"},
      {"^json/", "^(studies|palpate|modules/recording)/"},
      {"^CLI/", R"(^modules/runtime/program\.cpp$)"},
      {"^(thread|mutex|condition_variable|chrono|future)$|^(time|signal|pthread)\\.h$", no_physics},
      {"^spdlog/", no_physics + "|main\\.cpp$"},
      {"^fstream$",
       "^(?!deformation/|collision/|haptics/)|^haptics/devices/trajectory_file\\.cpp$"}};
  std::string violations;
  for (const auto& rule : rules) {
    const std::regex header(rule.header), place(rule.place);
    for (const auto& file : code()) {
      if (std::regex_search(file, place)) continue;
      for (const auto& include : includes_of(file)) {
        if (!std::regex_search(include.header, header)) continue;
        violations += line_for(include, "not here");
      }
    }
  }
  CHECK(violations == "");
}

TEST_CASE("structure: a session is wired by stages and nowhere else") {
  // Oracle: the rule of palpate/session/README.md: studies and benches run that session. Who owns a
  // world, a finder or a renderer, or gives a world its contacts, wires one of his own. The bench
  // of the finder alone gives nothing to a world; that of rows gives an organ what no session
  // would, a part of its rows.
  const std::regex wires(
      R"((ContactFinder|HapticRenderer)\b|\bset_contacts\(|DeformationWorld>?[ ]+\w+[;({]|<(deformation::)?DeformationWorld>)");
  const Names owners{"collision", "deformation", "haptics"};
  const Names benches{"bench/contact_search.cpp", "bench/contact_rows.cpp"};
  std::size_t checked = 0;
  std::string violations;
  for (const auto& file : code()) {
    if (owners.count(layer_of(file)) > 0 || benches.count(file) > 0) continue;
    ++checked;
    std::size_t number = 0;
    for (const auto& line : lines_of(file)) {
      ++number;
      const std::string code = line.substr(0, line.find("//"));
      if (!std::regex_search(code, wires)) continue;
      violations += file + ":" + std::to_string(number) + ": " + code + "\n";
    }
  }
  CHECK(violations == "");
  CHECK(checked > 200);
}
