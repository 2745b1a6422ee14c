#include "modules/core/data_folder.h"

#include <catch2/catch.hpp>
#include <cstdlib>
#include <fstream>

#include "modules/core/error.h"

namespace palpate {
namespace {

using Catch::Contains;

/// While one exists, PALPATE_SHARE is this.
class Share {
 public:
  explicit Share(const std::string& value) { ::setenv("PALPATE_SHARE", value.c_str(), 1); }
  ~Share() { ::unsetenv("PALPATE_SHARE"); }
  Share(const Share&) = delete;
  Share& operator=(const Share&) = delete;
};

TEST_CASE("data folder: what the programs need is found beside them") {
  // Oracle: the rule itself, ../share/palpate of the program's folder, and the shipped files.
  CHECK(std::filesystem::equivalent(program_folder(), PALPATE_BIN_DIR));
  CHECK(data_folder() == program_folder().parent_path() / "share/palpate");
  for (const char* name : {"scenes/stomach_probe.yaml", "scenes/meshes/stomach.ply",
                           "reference/A_ball_plates.csv", "plots/plot_accuracy.py"}) {
    INFO(name);
    CHECK(std::ifstream(data_file(name)).good());
  }
}

TEST_CASE("data folder: PALPATE_SHARE goes first, and what is missing is named") {
  // Oracle: the message.
  const Share share("/nowhere/share");
  CHECK(data_folder() == "/nowhere/share");
  CHECK_THROWS_AS(data_file("scenes/a.yaml"), InputError);
  CHECK_THROWS_WITH(data_file("scenes/a.yaml"),
                    Contains("/nowhere/share/scenes/a.yaml") && Contains("PALPATE_SHARE"));
}

}  // namespace
}  // namespace palpate
