#include "studies/contact_loop/contact_loop_command.h"

#include <catch2/catch.hpp>
#include <fstream>
#include <sstream>

#include "modules/core/data_folder.h"
#include "modules/core/error.h"
#include "tests/scratch_folder.h"

namespace palpate::contact_loop {

TEST_CASE(
    "contact loop command: a line for each ball and place and their sum, stopped within a press if "
    "asked") {
  // Oracle: the options; a press takes 1,000 ticks and more.
  ContactLoopOptions options;
  options.scenes = {data_file("scenes/stomach_probe.yaml")};
  options.tools = {"ball"};
  options.radii = {2e-3, 8e-3};
  options.speeds = {0.63};
  options.rates = {100};
  options.collision_rates = {250};
  options.places = 2;
  std::ostringstream out;
  CHECK(run_contact_loop(
            options, [] {}, out) == kExitDone);
  const std::string said = out.str();
  CHECK(std::count(said.begin(), said.end(), '\n') == 9);
  CHECK(said.find("4 runs:") != std::string::npos);
  CHECK(said.find(" 0 of them without contact") != std::string::npos);
  options.loss = 0.5;
  options.places = 1;
  std::ostringstream with_loss;
  run_contact_loop(
      options, [] {}, with_loss);
  const std::string row = with_loss.str().substr(with_loss.str().find('\n') + 1, 100);
  CHECK(said.find(row) == std::string::npos);
  int asked = 0;
  const auto stop_soon = [&] {
    if (++asked == 100) throw Interrupted("stopped");
  };
  CHECK_THROWS_AS(run_contact_loop(options, stop_soon, out), Interrupted);
}

TEST_CASE(
    "contact loop command: an organ that is not where the usual one is is pressed elsewhere") {
  // Oracle: the place in its line, 1 m aside.
  const ScratchFolder folder;
  const auto file = folder / "aside.yaml";
  std::ofstream(file) << "palpate_scene: 1\n"
                         "organs:\n"
                         "  - mesh: {file: "
                      << data_file("scenes/meshes/stomach.ply").string()
                      << ", nodes: 200}\n"
                         "    position_m: [1, 0, 0]\n"
                         "probes:\n"
                         "  - shape: {sphere: {radius_m: 0.008}}\n"
                         "    device: {scripted: {start_m: [1, -0.1, 0], moves: [{wait_s: 1}]}}\n";
  ContactLoopOptions options;
  options.scenes = {file};
  options.tools = {"ball"};
  options.radii = {8e-3};
  options.speeds = {2.5};
  options.rates = {100};
  options.collision_rates = {250};
  std::ostringstream out;
  run_contact_loop(
      options, [] {}, out);
  std::istringstream said(out.str());
  std::string line, scene;
  std::getline(said, line);
  double x = 0;
  said >> scene >> x;
  CHECK(scene == "aside");
  CHECK(std::abs(x - 1000) < 100);
}

}  // namespace palpate::contact_loop
