// Small and sharp tools in a hurry, in the loop that people run: real processes over DDS.
#include <catch2/catch.hpp>
#include <fstream>

#include "modules/core/data_folder.h"
#include "tests/scratch_folder.h"
#include "tests/system/launched.h"

using namespace palpate;
using namespace palpate::testing;

namespace {

/// In and out of the stomach's front at (x, z) [m], half a metre a second in the mean.
std::string probe(const std::string& name, const std::string& shape, double x, double z) {
  const auto at = [&](double y) {
    return "[" + std::to_string(x) + ", " + std::to_string(y) + ", " + std::to_string(z) + "]";
  };
  std::string moves;
  for (int press = 0; press < 8; ++press) {
    moves += "          - {to_m: " + at(-0.02) +
             ", duration_s: 0.1}\n          - {to_m: " + at(-0.07) + ", duration_s: 0.1}\n";
  }
  return "  - name: " + name + "\n    shape: " + shape +
         "\n    device:\n      scripted:\n        start_m: " + at(-0.07) + "\n        moves:\n" +
         moves;
}

std::filesystem::path write_scene(const std::filesystem::path& folder) {
  const auto file = folder / "fast.yaml";
  std::ofstream(file) << "palpate_scene: 1\norgans:\n  - name: stomach\n    mesh: {file: "
                      << data_file("scenes/meshes/stomach.ply").string()
                      << "}\n    fixed:\n      - box: {min_m: [-0.05, 0.02, -0.08], max_m: [0.06, "
                         "0.05, 0.05]}\nprobes:\n"
                      << probe("tip", "{sphere: {radius_m: 0.001}}", 0.022, -0.004)
                      << probe("needle", "{capsule: {radius_m: 0.0005, length_m: 0.04}}", 0.03,
                               0.03)
                      << probe("box", "{box: {size_m: [0.01, 0.01, 0.01]}}", 0.005, -0.045)
                      << probe("blade", "{box: {size_m: [0.001, 0.02, 0.015]}}", -0.02, -0.055)
                      << "rates: {deformation_hz: 100}\n";
  return file;
}

}  // namespace

TEST_CASE("fast presses: no tool is ever inside an organ without contact, live and in lockstep") {
  // Oracle: the guard of each search, a count of the closed surface's crossings (closed_surface.h),
  // as the summary tells it; and each tool was felt.
  const ScratchFolder folder;
  const auto scene = write_scene(folder.path());
  for (const bool lockstep : {false, true}) {
    std::vector<std::string> options{"--duration", "1.8"};
    if (lockstep) options.push_back("--lockstep");
    Launched run(scene, options);
    CHECK(run.wait_for_end() == 0);
    INFO(run.said());
    CHECK_THAT(run.said(), Catch::Contains("0 with a probe inside without contact"));
    CHECK_THAT(run.said(), !Catch::Contains("force at most 0.000 N"));
  }
}
