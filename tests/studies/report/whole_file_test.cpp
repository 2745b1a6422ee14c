#include "studies/report/whole_file.h"

#include <catch2/catch.hpp>

#include "tests/scratch_folder.h"

namespace palpate::report {
namespace {

TEST_CASE("whole file: without finish nothing is left, and what was there stays") {
  // Oracle: the folder.
  const ScratchFolder folder;
  const auto file = folder / "a.csv";
  std::ofstream(file) << "old";
  {
    WholeFile whole(file);
    whole.stream() << "new" << std::flush;
    CHECK(text_in(file) == "old");
  }
  CHECK(text_in(file) == "old");
  CHECK(std::distance(std::filesystem::directory_iterator(folder.path()), {}) == 1);
  write_whole_file(file, "new");
  CHECK(text_in(file) == "new");
  CHECK(std::distance(std::filesystem::directory_iterator(folder.path()), {}) == 1);
}

TEST_CASE("whole file: where nothing can be written it says so") {
  // Oracle: the message.
  CHECK_THROWS_WITH(WholeFile("/nowhere/a.csv"),
                    Catch::StartsWith("cannot write /nowhere/a.csv.") && Catch::EndsWith(".part"));
  // A disk that is full: it opens, and takes nothing.
  WholeFile whole(ScratchFolder() / "a.csv");
  whole.stream().setstate(std::ios::badbit);
  CHECK_THROWS_WITH(whole.finish(), Catch::StartsWith("cannot write"));
}

}  // namespace
}  // namespace palpate::report
