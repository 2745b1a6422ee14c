#include "modules/core/output_file.h"

#include <catch2/catch.hpp>

#include "modules/core/error.h"
#include "tests/scratch_folder.h"

using namespace palpate;

TEST_CASE("output file: what cannot be written is known before") {
  // Oracle: the texts by hand; permissions are root's in some places and not asked for here.
  const ScratchFolder folder;
  const std::string at = folder.path().string();
  CHECK(why_not_writable(folder / "new").empty());
  std::ofstream(folder / "old") << "x";
  CHECK(why_not_writable(folder / "old").empty());
  CHECK(why_not_writable(folder.path()) == "it is a folder");
  CHECK(why_not_writable(folder / "no/new") == "there is no folder " + at + "/no");
  CHECK(why_not_writable(folder / "old/new") == "there is no folder " + at + "/old");
  CHECK_FALSE(std::filesystem::exists(folder / "new"));
  CHECK_THROWS_AS(check_writable(folder.path()), InputError);
  CHECK_NOTHROW(check_writable("/dev/null"));
}
