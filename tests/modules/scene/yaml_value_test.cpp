#include "modules/scene/yaml_value.h"

#include <vector>

#include "tests/modules/scene/scene_text.h"

using namespace palpate;
using namespace palpate::scene;
using namespace palpate::scene::test;

namespace {

struct Refusal {
  std::string from, to;  // one place of the full scene, and what it is changed to
  std::string message;   // after "scene.yaml:"
};

void check(const std::vector<Refusal>& refusals) {
  const SceneFolder folder;
  for (const auto& [from, to, message] : refusals) {
    INFO(from << " → " << to);
    CHECK(folder.refusal(changed(from, to)) == "scene.yaml:" + message);
  }
}

}  // namespace

TEST_CASE("yaml value: what is not a number is refused") {
  // Oracle: YAML 1.2 core schema for plain decimal numbers, and the messages promised.
  const std::string key = "9: key 'organs[0].tissue.youngs_modulus_pa' = ";
  check({{"20e3", "soft", key + "'soft': must be a number"},
         {"20e3", "'20e3'", key + "'20e3': must be a number"},
         {"20e3", "20 kPa", key + "'20 kPa': must be a number"},
         {"20e3", "20,000", key + "'20,000': must be a number"},
         {"20e3", "0x10", key + "'0x10': must be a number"},
         {"20e3", "true", key + "'true': must be a number"},
         {"20e3", "[1, 2]", key + "'[1, 2]': must be a number"},
         {"20e3", "{a: 1}", key + "'{…}': must be a number"},
         {"20e3", "~", key + "'null': must be a number"},
         {"20e3", "", key + "'null': must be a number"}});
}

TEST_CASE("yaml value: numbers that are not finite are refused") {
  // Oracle: IEEE 754: the largest double is below 1.8e308.
  const std::string key = "9: key 'organs[0].tissue.youngs_modulus_pa' = ";
  check({{"20e3", ".nan", key + "'.nan': must be finite"},
         {"20e3", ".inf", key + "'.inf': must be finite"},
         {"20e3", "-.inf", key + "'-.inf': must be finite"},
         {"20e3", "inf", key + "'inf': must be finite"},
         {"20e3", "nan", key + "'nan': must be finite"},
         {"20e3", "1e999", key + "'1e999': must be finite"},
         {"[0.1, 0.2, 0.3]", "[0, .nan, 0]",
          "6: key 'organs[0].position_m' = '[0, .nan, 0]': must be finite"}});
}

TEST_CASE("yaml value: a number may be written in any decimal form") {
  // Oracle: twenty thousand, in four spellings.
  const SceneFolder folder;
  for (const std::string text : {"20000", "+20e3", "2E+4", "20000.0"}) {
    INFO(text);
    CHECK(folder.parse(changed("20e3", text)).organs[0].tissue.youngs_modulus == 20000);
  }
}

TEST_CASE("yaml value: every number has its range, whose ends belong to it") {
  // Oracle: the ranges of scene.h, written out again: what, where, below, lowest, highest, above.
  struct Range {
    std::string line, place, below, lowest, highest, above, text;
  };
  const std::vector<Range> ranges{
      {"9", "youngs_modulus_pa: 20e3", "99", "100", "1e7", "1.1e7", "100 and 1e+07 Pa"},
      {"10", "wall_thickness_m: 0.004", "9e-5", "1e-4", "0.05", "0.051", "1e-04 and 0.05 m"},
      {"11", "density_kg_per_m3: 1000", "99", "100", "5000", "5001", "100 and 5000 kg/m³"},
      {"12", "damping_ratio: 0.2", "-0.1", "0", "2", "2.1", "0 and 2"},
      {"13", "drag_per_s: 3", "-1", "0", "100", "101", "0 and 100 1/s"},
      {"15", "bending_ratio: 0.4", "-0.1", "0", "10", "10.1", "0 and 10"},
      {"16", "inner_ratio: 0.7", "-0.1", "0", "100", "101", "0 and 100"},
      {"17", "virtual_nodes: 5", "-1", "1", "64", "65", "0 and 64"},
      {"29", "radius_m: 0.04", "9e-5", "1e-4", "10", "11", "1e-04 and 10 m"},
      {"37", "radius_m: 0.007", "9e-5", "1e-4", "0.5", "0.6", "1e-04 and 0.5 m"},
      {"38", "friction: 0.3", "-0.1", "0", "2", "2.1", "0 and 2"},
      {"44", "duration_s: 2.5", "0", "1e-3", "3600", "3601", "0.001 and 3600 s"},
      {"45", "wait_s: 0.5", "0", "1e-3", "3600", "3601", "0.001 and 3600 s"},
      {"47", "radius_m: 0.003", "9e-5", "1e-4", "0.5", "0.6", "1e-04 and 0.5 m"},
      {"47", "length_m: 0.2", "9e-5", "1e-4", "2", "2.1", "1e-04 and 2 m"},
      {"5", "nodes: 550", "-1", "0", "200000", "200001", "0 and 2e+05"},
      {"70", "mass_kg: 0.3", "0.009", "0.01", "10", "11", "0.01 and 10 kg"},
      {"71", "damping_n_s_per_m: 0.7", "-1", "0", "100", "101", "0 and 100 N·s/m"},
      {"72", "max_force_n: 6", "0", "0.1", "100", "101", "0.1 and 100 N"},
      {"73", "encoder_step_m: 1e-6", "-1", "0", "0.01", "0.011", "0 and 0.01 m"},
      {"74", "rate_hz: 4000", "99", "100", "10000", "10001", "100 and 10000 Hz"},
      {"75", "transport_delay_s: 5e-4", "-1", "0", "0.1", "0.11", "0 and 0.1 s"},
      {"77", "mass_kg: 0.25", "-1", "0", "5", "5.1", "0 and 5 kg"},
      {"78", "damping_n_s_per_m: 3", "-1", "0", "100", "101", "0 and 100 N·s/m"},
      {"79", "stiffness_n_per_m: 150", "-1", "0", "5000", "5001", "0 and 5000 N/m"},
      {"85", "duration_s: 20", "-1", "0", "1e6", "1.1e6", "0 and 1e+06 s"},
      {"86", "haptics_hz: 2000", "499", "500", "4000", "4001", "500 and 4000 Hz"},
      {"86", "collision_hz: 500", "9", "10", "2000", "2001", "10 and 2000 Hz"},
      {"86", "deformation_hz: 400", "9", "10", "2000", "2001", "10 and 2000 Hz"},
      {"86", "visualizer_hz: 60", "0.9", "1", "120", "121", "1 and 120 Hz"},
      {"88", "max_force_n: 5", "0", "0.1", "100", "101", "0.1 and 100 N"},
      {"89", "max_force_rate_n_per_s: 300", "0", "1", "1e5", "1.1e5", "1 and 1e+05 N/s"},
      {"90", "device_damping_n_s_per_m: 0.4", "-1", "0", "50", "51", "0 and 50 N·s/m"},
      {"91", "stale_after_s: 0.06", "0.004", "0.005", "1", "1.1", "0.005 and 1 s"},
      {"92", "fade_time_s: 0.07", "0.004", "0.005", "1", "1.1", "0.005 and 1 s"},
      {"19", "volume_corrections: 2", "-1", "0", "5", "6", "0 and 5"},
      {"25", "breathing_amplitude: 0.1", "-0.1", "0", "0.5", "0.6", "0 and 0.5"},
      {"26", "breathing_hz: 0.4", "0", "0.01", "5", "6", "0.01 and 5 Hz"},
      {"94", "deformation_threads: 3", "0", "1", "16", "17", "1 and 16"},
      {"95", "friction: 0.25", "-0.1", "0", "2", "2.1", "0 and 2"},
      {"27", "max_rate_per_s: 0.7", "0", "0.001", "10", "11", "0.001 and 10 1/s"}};
  const SceneFolder folder;
  for (const auto& range : ranges) {
    const std::string key = range.place.substr(0, range.place.find(' '));
    const auto refusal = [&](const std::string& value) {
      return folder.refusal(changed(range.place, key + " " + value));
    };
    INFO(range.place);
    CHECK(refusal(range.lowest) == "accepted");
    CHECK(refusal(range.highest) == "accepted");
    for (const std::string& outside : {range.below, range.above}) {
      CHECK_THAT(refusal(outside),
                 Catch::StartsWith("scene.yaml:" + range.line + ": key '") &&
                     Catch::EndsWith(key.substr(0, key.size() - 1) + "' = '" + outside +
                                     "': must be between " + range.text));
    }
  }
}

TEST_CASE("yaml value: a whole number has no fraction") {
  // Oracle: the messages promised; 1e2 is a whole number however it is spelt.
  const SceneFolder folder;
  check({{"nodes: 550", "nodes: 550.5",
          "5: key 'organs[0].mesh.nodes' = '550.5': must be a whole number"},
         {"nodes: 550", "nodes: many",
          "5: key 'organs[0].mesh.nodes' = 'many': must be a whole number"}});
  CHECK(folder.parse(changed("nodes: 550", "nodes: 1e2")).organs[0].mesh.nodes == 100);
}

TEST_CASE("yaml value: true and false are spelt so") {
  // Oracle: YAML 1.2 core schema; the YAML 1.1 spellings yes, on, True are refused.
  for (const std::string text : {"yes", "on", "True", "1", "'true'", "[true]"}) {
    const SceneFolder folder;
    INFO(text);
    CHECK_THAT(folder.refusal(changed("loop: true", "loop: " + text)),
               Catch::StartsWith("scene.yaml:53: key 'probes[1].device.trajectory.loop' = '") &&
                   Catch::EndsWith("': must be true or false"));
  }
}

TEST_CASE("yaml value: points are lists of three numbers within a hundred metres") {
  // Oracle: the messages promised.
  const std::string key = "6: key 'organs[0].position_m' = ";
  const std::string place = "position_m: [0.1, 0.2, 0.3]";
  check({{place, "position_m: [0.1, 0.2]",
          key + "'[0.1, 0.2]': must be a list of 3 numbers [x, y, z]"},
         {place, "position_m: [1, 2, 3, 4]",
          key + "'[1, 2, 3, 4]': must be a list of 3 numbers [x, y, z]"},
         {place, "position_m: 0.1", key + "'0.1': must be a list of 3 numbers [x, y, z]"},
         {place, "position_m: {x: 1, y: 2, z: 3}",
          key + "'{…}': must be a list of 3 numbers [x, y, z]"},
         {place, "position_m: [0.1, up, 0.3]",
          key + "'[0.1, up, 0.3]': must be a list of 3 numbers [x, y, z]"},
         {place, "position_m: [0.1, [0], 0.3]",
          key + "'[0.1, …, 0.3]': must be a list of 3 numbers [x, y, z]"},
         {place, "position_m: [0, 0, 101]",
          key + "'[0, 0, 101]': each number must be between -100 and 100 m"},
         {"[0.01, 0.02, 0.03]}}", "[0.01, 0, 0.03]}}",
          "55: key 'probes[2].shape.box.size_m' = '[0.01, 0, 0.03]': each number must be between "
          "1e-04 and 2 m"},
         {"[0, 0, -9.81]", "[0, 0, -981]",
          "84: key 'gravity_m_per_s2' = '[0, 0, -981]': each number must be between -100 and 100 "
          "m/s²"}});
}

TEST_CASE("yaml value: rotations are unit quaternions") {
  // Oracle: lengths computed by hand: √(0.25+0.25) and √(0.36+0.6561).
  const std::string key = "7: key 'organs[0].rotation_xyzw' = ";
  check({{"[0, 0, 0.6, 0.8]", "[0, 0, 0.8]",
          key + "'[0, 0, 0.8]': must be a list of 4 numbers [x, y, z, w]"},
         {"[0, 0, 0.6, 0.8]", "[0, 0, 0, w]",
          key + "'[0, 0, 0, w]': must be a list of 4 numbers [x, y, z, w]"},
         {"[0, 0, 0.6, 0.8]", "[0, 0, 0, 0]",
          key + "'[0, 0, 0, 0]': must be a unit quaternion [x, y, z, w] (length 1 within 0.001, "
                "here 0)"},
         {"[0, 0, 0.6, 0.8]", "[0, 0, 3, 4]",
          key + "'[0, 0, 3, 4]': must be a unit quaternion [x, y, z, w] (length 1 within 0.001, "
                "here 5)"},
         {"[0, 0, 0.6, 0.8]", "[1e200, 0, 0, 1e200]",
          key + "'[1e200, 0, 0, 1e200]': must be a unit quaternion [x, y, z, w] (length 1 within "
                "0.001, here inf)"}});
}

TEST_CASE("yaml value: a quaternion typed with three digits is normalised") {
  // Oracle: 45° about z; sin and cos of 22.5°. Three digits are good to 5e-4.
  const SceneFolder folder;
  const Quat rotation =
      folder.parse(changed("[0, 0, 0.6, 0.8]", "[0, 0, 0.383, 0.924]")).organs[0].pose.rotation;
  CHECK(std::abs(rotation.norm() - 1) < 1e-15);
  CHECK(std::abs(rotation.z() - std::sin(0.3926990816987241)) < 5e-4);
}

TEST_CASE("yaml value: a unit of length must be one that is known") {
  // Oracle: metres_per_unit() of the core.
  const std::string key = "5: key 'organs[0].mesh.unit' = ";
  check({{"unit: mm", "unit: furlong",
          key + "'furlong': unit 'furlong' is not known; allowed: m, dm, cm, mm, um, in"},
         {"unit: mm", "unit: [mm]", key + "'[mm]': must be a text"}});
}

TEST_CASE("yaml value: a name is a short text in one line") {
  // Oracle: the messages promised.
  const std::string key = "4: key 'organs[0].name' = ";
  const std::string must = "': must be a text of 1 to 255 bytes without control characters";
  check({{"name: stomach", "name: ''", key + "'" + must},
         {"name: stomach", "name: \"a\\nb\"", key + "'a b" + must},
         {"name: stomach", "name: " + std::string(256, 'x'),
          key + "'" + std::string(60, 'x') + "…" + must},
         {"name: stomach", "name: [a]", key + "'[a]': must be a text"},
         {"name: stomach", "name:", key + "'null': must be a text"}});
}

TEST_CASE("yaml value: a name is UTF-8") {
  // Oracle: Unicode's table 3-7, its first and last good sequences and those beside them.
  const std::string key = "4: key 'organs[0].name' = '";
  for (const char* bad :
       {"\x80", "\xc1\xbf", "\xe0\x9f\xbf", "\xed\xa0\x80", "\xf0\x8f\xbf\xbf", "\xf4\x90\x80\x80",
        "\xf5\x80\x80\x80", "\xc3", "\xe2\x82", "\xe2\x82z"}) {
    const std::string name = std::string("a") + bad;
    check({{"name: stomach", "name: \"" + name + "\"", key + name + "': must be UTF-8"}});
  }
  for (const char* good : {"Größe", "\xc2\x80", "\xdf\xbf", "\xe0\xa0\x80", "\xed\x9f\xbf",
                           "\xef\xbf\xbf", "\xf0\x90\x80\x80", "\xf4\x8f\xbf\xbf"}) {
    const YAML::Node node(good);
    const Source source{"scene.yaml", {}};
    CHECK_NOTHROW(check_name({node, 1, "name", &source}, good));
  }
}

TEST_CASE("yaml value: a file must be there, be a file and be readable") {
  // Oracle: the file system.
  check({{"tool.stl", "none.stl",
          "61: key 'probes[4].shape.mesh.file' = 'none.stl': no such file: none.stl"},
         {"tool.stl", "''", "61: key 'probes[4].shape.mesh.file' = '': must name a file"},
         {"tool.stl", "[tool.stl]",
          "61: key 'probes[4].shape.mesh.file' = '[tool.stl]': must name a file"},
         {"press.csv", "missing/press.csv",
          "50: key 'probes[1].device.trajectory.file' = 'missing/press.csv': no such file: "
          "missing/press.csv"}});
  const SceneFolder folder;
  folder.write("folder/inside", "");
  CHECK(folder.refusal(changed("tool.stl", "folder")) ==
        "scene.yaml:61: key 'probes[4].shape.mesh.file' = 'folder': is a folder, not a file: "
        "folder");
}

TEST_CASE("yaml value: a file without permission is refused") {
  // Oracle: the file system's permissions.
  const SceneFolder folder;
  std::filesystem::permissions(folder.path() / "tool.stl", std::filesystem::perms::none);
  const AsNobody nobody;
  CHECK(folder.refusal(kFullScene) ==
        "scene.yaml:61: key 'probes[4].shape.mesh.file' = 'tool.stl': may not be read: tool.stl");
}
