#include "modules/scene/schema.h"

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <utility>

#include "modules/scene/models.h"
#include "modules/scene/schema_reference.h"
#include "tests/modules/scene/scene_text.h"

using namespace palpate;
using namespace palpate::scene;
using namespace palpate::scene::test;

namespace {

/// The numbers on both sides of the first " … " of a text.
std::pair<double, double> range_in(const std::string& text) {
  const auto at = text.find(" … ");
  if (at == std::string::npos) return {};
  const auto begin = text.find_last_of("[ ", at - 1) + 1;  // npos + 1 = 0
  return {std::strtod(text.c_str() + begin, nullptr),
          std::strtod(text.c_str() + at + std::string(" … ").size(), nullptr)};
}

}  // namespace

TEST_CASE("schema: keys of a recording go with its kind of file") {
  // Oracle: the rules of the trajectory's table.
  const SceneFolder folder;
  folder.write("press.bag", "");
  folder.write("press.mcap", "");
  const auto said = [&](const std::string& keys) {
    std::string text = kMinimalScene;
    const auto device = text.find("device:");
    REQUIRE(device != std::string::npos);
    text.resize(device);
    return folder.refusal(text + "device: {trajectory: {" + keys + "}}\n");
  };
  CHECK(said("file: press.csv, columns: [t, x, y, z], time_unit: us, length_unit: in") ==
        "accepted");
  for (const std::string bag : {"press.bag", "press.mcap"}) {
    CHECK(said("file: " + bag + ", topic: /tool, length_unit: mm") == "accepted");
    CHECK_THAT(said("file: " + bag + ", time_unit: ms"),
               Catch::EndsWith("are of tables; a bag's messages need none"));
  }
  CHECK_THAT(said("file: press.csv, columns: [t, x, y]"),
             Catch::EndsWith("columns must name 4 (time, x, y, z) or 8 (and the quaternion)"));
  CHECK_THAT(said("file: press.csv, topic: /tool"),
             Catch::EndsWith("topic is of bags (.bag, .mcap)"));
  for (const char* key : {"time_unit: ms", "quaternion: wxyz", "columns: [t, x, y, z]"}) {
    CHECK_THAT(said(std::string("file: press.bag, ") + key),
               Catch::EndsWith("are of tables; a bag's messages need none"));
  }
  CHECK_THAT(said("file: press.csv, time_unit: min"), Catch::Contains("s, ms, us, ns"));
  CHECK_THAT(said("file: press.csv, length_unit: furlong"), Catch::Contains("allowed: m, dm, cm"));
  CHECK_THAT(said("file: press.csv, quaternion: zyxw"), Catch::Contains("xyzw, wxyz"));
}

TEST_CASE("schema: inner springs need virtual nodes to hang on") {
  // Oracle: the rule of the springs' table.
  const std::string rule =
      "inner_ratio must be 0 where virtual_nodes is 0 (inner springs hang on virtual nodes)";
  CHECK(refusal("virtual_nodes: 5", "virtual_nodes: 0") ==
        "scene.yaml:14: key 'organs[0].springs' = '{…}': " + rule);
  CHECK(refusal("inner_ratio: 0.7\n      virtual_nodes: 5",
                "inner_ratio: 0\n      virtual_nodes: 0") == "accepted");
  CHECK(refusal("inner_ratio: 0.7", "inner_ratio: 0") == "accepted");
}

/// What is said of the minimal scene with this model and one more key of the organ.
std::string said_of(const std::string& model, const std::string& more) {
  const std::string mesh = "mesh: {file: organ.ply}";
  std::string text = kMinimalScene;
  text.replace(text.find(mesh), mesh.size(), mesh + "\n    model: " + model + "\n    " + more);
  return SceneFolder().refusal(text);
}

TEST_CASE("schema: a key that the model does not read is refused, whatever the model") {
  // Oracle: the table of models; one that reads the key accepts the same line.
  for (const ModelFormat& format : model_formats()) {
    INFO(format.word);
    const auto accepts = [&](const std::string& line) {
      const std::string said = said_of(format.word, line);
      if (said == "accepted") return true;
      const std::string key = line.substr(0, line.find(':'));
      CHECK_THAT(said, Catch::StartsWith("scene.yaml:5: key 'organs[0]." + key));
      CHECK_THAT(said, Catch::Contains(std::string("is not read by model ") + format.word) ||
                           Catch::Contains(std::string("does not go with model ") + format.word));
      return false;
    };
    CHECK(accepts("iterations: 8") == (format.iterations > 0));
    CHECK(accepts("integrator: backward_euler") == format.has_integrator);
    CHECK(accepts("volume_corrections: 1") == format.has_volume_corrections);
    CHECK(accepts("springs: {inner_ratio: 10}") == !format.is_solid());
    CHECK(accepts("filling: {breathing_amplitude: 0.1}") == !format.is_solid());
    CHECK(accepts("solid: {poisson_ratio: 0.3}") == format.is_solid());
    CHECK(accepts("solid: {element_size_m: 0.02}") == format.is_solid());
    CHECK(accepts("solid: {modes: 7}") == format.has_modes);
    CHECK(accepts("solid: {refine: {near: [sphere: {center_m: [0, 0, 0]}]}}") == format.is_solid());
    CHECK(accepts("tissue: {wall_thickness_m: 0.01}") == !format.is_solid());
    CHECK(accepts("tissue: {damping_ratio: 0.3}") == (!format.is_solid() || format.has_modes));
  }
  CHECK_THAT(said_of("xpbd_springs", "iterations: 1001"), Catch::Contains("0 and 1000"));
}

TEST_CASE("schema: a model that locks is refused incompressible tissue") {
  // Oracle: the table of models.
  for (const ModelFormat& format : model_formats()) {
    if (!format.is_solid()) continue;
    const std::string said = said_of(format.word, "solid: {poisson_ratio: 0.5}");
    INFO(format.word);
    CHECK((said == "accepted") == (format.largest_poisson_ratio == 0.5));
    if (said != "accepted") CHECK_THAT(said, Catch::Contains("needs at most 0.4999"));
  }
}

TEST_CASE("schema: a box has a lowest and a highest corner") {
  // Oracle: the rule of the box's table, broken in each axis and by a flat box.
  const std::string message =
      "scene.yaml:30: key 'organs[0].fixed[1].box' = '{…}': min_m must be below max_m in each of "
      "x, y, z";
  for (const std::string max : {"[-1.5, 2, 3]", "[1, -2.5, 3]", "[1, 2, -3.5]", "[1, 2, -3]"}) {
    INFO(max);
    CHECK(refusal("max_m: [1, 2, 3]", "max_m: " + max) == message);
  }
}

TEST_CASE("schema: a move either goes somewhere in a time, or waits") {
  // Oracle: every wrong subset of the three keys.
  const std::string message =
      "scene.yaml:45: key 'probes[0].device.scripted.moves[1]' = '{…}': must hold either to_m and "
      "duration_s, or wait_s alone";
  for (const std::string move :
       {"{to_m: [0, 0, 0]}", "{duration_s: 1}", "{to_m: [0, 0, 0], wait_s: 1}",
        "{duration_s: 1, wait_s: 1}", "{to_m: [0, 0, 0], duration_s: 1, wait_s: 1}"}) {
    INFO(move);
    CHECK(refusal("{wait_s: 0.5}", move) == message);
  }
  CHECK(refusal("{wait_s: 0.5}", "{}") ==
        "scene.yaml:45: key 'probes[0].device.scripted.moves[1]' = '{}': must hold either to_m "
        "and duration_s, or wait_s alone");
}

TEST_CASE("schema: a filling's points rise in time") {
  // Oracle: the rule, word by word.
  const SceneFolder folder;
  CHECK(folder.refusal(changed("{at_s: 5,", "{at_s: 0,")) ==
        "scene.yaml:21: key 'organs[0].filling' = '{…}': at_s must rise from point to point");
}

TEST_CASE("schema: an unknown model or integrator is refused with all there are") {
  // Oracle: the table of models; the integrators, written out again.
  const SceneFolder folder;
  std::string words;
  for (const ModelFormat& format : model_formats()) {
    words += (words.empty() ? "" : ", ") + std::string(format.word);
  }
  CHECK(folder.refusal(changed("model: implicit_volume", "model: tetrahedra")) ==
        "scene.yaml:18: key 'organs[0].model' = 'tetrahedra': must be one of: " + words);
  CHECK(folder.refusal(changed("backward_euler", "euler")) ==
        "scene.yaml:20: key 'organs[0].integrator' = 'euler': must be one of: automatic, "
        "symplectic_euler, backward_euler");
}

TEST_CASE("schema: the camera does not look at itself") {
  // Oracle: the rule of the camera's table.
  CHECK(refusal("target_m: [0, 0, 0.1]", "target_m: [0, -1, 0]") ==
        "scene.yaml:93: key 'camera' = '{…}': position_m and target_m must differ");
  CHECK(refusal("position_m: [0, -1, 0], ", "") == "accepted");
}

TEST_CASE("schema: the comments of scene.h state the keys and ranges that are enforced") {
  // Oracle: the two texts are written separately; each "`key` … [low … high]" of scene.h must be
  // a row of the reference with that range.
  std::ifstream header(PALPATE_SOURCE_DIR "/modules/scene/scene.h");
  const std::string reference = schema_reference();
  int count = 0;
  for (std::string line; std::getline(header, line);) {
    const auto open = line.find('['), tick = line.find('`');
    if (open == std::string::npos || tick > open || line.find(" … ") == std::string::npos) continue;
    const std::string key = line.substr(tick, line.find('`', tick + 1) + 1 - tick);
    INFO(line);
    bool found = false;
    std::istringstream rows(reference);
    for (std::string row; std::getline(rows, row);) {
      if (row.starts_with("| " + key + " |")) {
        found = found || range_in(row) == range_in(line.substr(open + 1));
      }
    }
    CHECK(found);
    ++count;
  }
  CHECK(count >= 25);  // of the 26 that were there when this was written
}
