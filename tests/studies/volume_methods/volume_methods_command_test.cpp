#include "studies/volume_methods/volume_methods_command.h"

#include <unistd.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <fstream>
#include <sstream>

#include "modules/core/data_folder.h"
#include "modules/core/error.h"

namespace palpate::volume_methods {
namespace {

struct ScratchFolder {
  std::filesystem::path path = std::filesystem::temp_directory_path() /
                               ("palpate_volume_methods_" + std::to_string(getpid()));
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
  }
};

VolumeMethodsOptions quick_options() {
  VolumeMethodsOptions options;
  options.quick = true;
  options.only = {"mass_spring", "implicit_volume"};
  options.scene = data_file("scenes/stomach_probe.yaml");
  return options;
}

TEST_CASE("volume methods command: a line per method on screen and in the file, the same columns") {
  // Oracle: the table's shape, and that the constraint's column says what it must.
  const ScratchFolder folder;
  auto options = quick_options();
  options.out = folder.path / "deep";
  std::ostringstream out, log;
  REQUIRE(run_volume_methods(options, out, log) == kExitDone);
  CHECK_THAT(out.str(), Catch::Contains("mass_spring") && Catch::Contains("implicit_volume"));
  CHECK_THAT(log.str(), Catch::Contains("implicit_volume"));

  std::ifstream file(options.out / "volume_methods.csv");
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);) lines.push_back(line);
  REQUIRE(lines.size() == 3);
  const auto commas = std::count(lines[0].begin(), lines[0].end(), ',');
  CHECK(commas == 11);
  for (const auto& line : lines) CHECK(std::count(line.begin(), line.end(), ',') == commas);
  const auto first_value = [](const std::string& line) {
    return std::stod(line.substr(line.find(',') + 1));
  };
  CHECK(first_value(lines[1]) > 0.05);
  CHECK(first_value(lines[2]) < 1e-5);
}

TEST_CASE(
    "volume methods command: a scene or folder that cannot be used is refused before the work") {
  // Oracle: InputError, exit code 2 in main.
  std::ostringstream out, log;
  auto options = quick_options();
  options.scene = "nowhere.yaml";
  CHECK_THROWS_AS(run_volume_methods(options, out, log), InputError);
  options = quick_options();
  options.out = "/proc/nowhere";
  CHECK_THROWS_AS(run_volume_methods(options, out, log), InputError);
  CHECK(out.str().empty());
}

}  // namespace
}  // namespace palpate::volume_methods
