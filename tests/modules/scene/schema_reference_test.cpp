#include "modules/scene/schema_reference.h"

#include <fstream>
#include <sstream>

#include "tests/modules/scene/scene_text.h"

using namespace palpate::scene;
using namespace palpate::scene::test;

namespace {

std::string page() {
  std::ifstream stream(PALPATE_SOURCE_DIR "/docs/scene.md");
  REQUIRE(stream);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// Text of a page between two marks.
std::string between(const std::string& text, const std::string& begin, const std::string& end) {
  const auto first = text.find(begin);
  REQUIRE(first != std::string::npos);
  const auto last = text.find(end, first + begin.size());
  REQUIRE(last != std::string::npos);
  return text.substr(first + begin.size(), last - first - begin.size());
}

}  // namespace

TEST_CASE("schema reference: docs/scene.md holds it word by word") {
  // Oracle: the schema the reader enforces. On a difference the new text is in the file named.
  const std::string expected = schema_reference();
  const std::string found =
      between(page(), "<!-- begin of the generated reference -->\n\n", "<!-- end -->");
  if (found != expected) {
    std::ofstream("schema_reference.md") << expected;
    FAIL("docs/scene.md differs from the schema; the new reference is in "
         << std::filesystem::absolute("schema_reference.md"));
  }
  CHECK(found == expected);
}

TEST_CASE("schema reference: names every key of a scene that uses them all") {
  // Oracle: the keys of the resolved full scene, found as text.
  const SceneFolder folder;
  std::istringstream lines(resolved_text(folder.parse(kFullScene)));
  const std::string reference = schema_reference();
  int count = 0;
  for (std::string line; std::getline(lines, line); ++count) {
    const auto begin = line.find_first_not_of(" -");
    const std::string key = line.substr(begin, line.find(':') - begin);
    INFO(line);
    CHECK(reference.find("| `" + key + "` |") != std::string::npos);
  }
  CHECK(count > 80);
}

TEST_CASE("schema reference: a row has type, unit, range, default and meaning") {
  // Oracle: one row of each kind, written by hand.
  const std::string reference = schema_reference();
  for (const std::string row :
       {"| `youngs_modulus_pa` | number | Pa | 100 … 1e+07 | `10000` | stiffness of the wall |\n",
        "| `virtual_nodes` | whole number |  | 0 … 64 | `6` | ",
        "| `loop` | true or false |  |  | `false` | ",
        "| `integrator` | automatic, symplectic_euler, backward_euler |  |  | `automatic` | ",
        "| `organs` | list |  |  | required | ", "| `file` | file |  |  | required | ",
        "| `size_m` | [x, y, z] | m | 1e-04 … 2 | `[0.02, 0.02, 0.02]` | "}) {
    INFO(row);
    CHECK(reference.find(row) != std::string::npos);
  }
}

TEST_CASE("docs/scene.md: its minimal example is a scene") {
  // Oracle: the reader, on the example as printed.
  const std::string example = between(page(), "```yaml\n", "```");
  CHECK(example.find("palpate_scene: 1") == 0);
  const Scene scene = parse_scene(example, PALPATE_SOURCE_DIR "/scenes/example.yaml");
  CHECK(scene.organs.size() == 1);
  CHECK(scene.probes.size() == 1);
}
