#include "studies/report/point_files.h"

#include <catch2/catch.hpp>
#include <sstream>

#include "modules/core/error.h"
#include "tests/scratch_folder.h"
#include "tests/studies/damages.h"

namespace palpate::report {
namespace {

constexpr const char* kText = "y,state\n0.125,1\n0.5,3\n";

TEST_CASE("point files: what was written is read back, what was not is silently none") {
  // Oracle: round trip, and the seal as the header says it.
  const ScratchFolder folder;
  std::ostringstream log;
  const PointFiles files(folder.path(), log);
  CHECK_FALSE(files.read("point.csv"));
  files.write("point.csv", kText);
  CHECK(files.read("point.csv") == kText);
  CHECK_THAT(text_in(folder / "point.csv"),
             Catch::StartsWith(kText) && Catch::Contains("\n# sealed: 3 lines, CRC-32 "));
  CHECK(log.str().empty());
  std::filesystem::create_directory(folder / "folder.csv");
  CHECK_THROWS_AS(files.read("folder.csv"), InputError);
}

TEST_CASE("point files: cut anywhere or changed in any byte a point is named and not believed") {
  // Oracle: each cut, and each bit of each byte, of a file known to be whole.
  const ScratchFolder folder;
  std::ostringstream written;
  PointFiles(folder.path(), written).write("point.csv", kText);
  const std::string whole = text_in(folder / "point.csv");
  std::vector<std::string> texts = damaged(whole);
  for (std::size_t i = 0; i < whole.size(); ++i) {
    texts.push_back(whole.substr(0, i));
    for (int bit = 0; bit < 8; ++bit) {
      texts.push_back(whole);
      texts.back()[i] = static_cast<char>(texts.back()[i] ^ (1 << bit));
    }
  }
  for (const std::string& text : texts) {
    INFO(text);
    folder.write("point.csv", text);
    std::ostringstream log;
    const PointFiles files(folder.path(), log);
    CHECK_FALSE(files.read("point.csv"));
    CHECK_THAT(log.str(), Catch::StartsWith((folder / "point.csv").string() + ": was "));
    const std::string said = log.str();
    CHECK_FALSE(files.read("point.csv"));
    CHECK(log.str() == said);  // once
  }
  std::ostringstream log;
  PointFiles(folder.path(), log).write("point.csv", kText);
  CHECK(text_in(folder / "point.csv") == whole);
}

}  // namespace
}  // namespace palpate::report
