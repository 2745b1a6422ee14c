#include "studies/fuzz/block_store.h"

#include <catch2/catch.hpp>
#include <sstream>

#include "tests/scratch_folder.h"
#include "tests/studies/chart/folders.h"
#include "tests/studies/damages.h"

namespace palpate::fuzz {
namespace {

TEST_CASE("block store: what was written is read back, blocks of other seeds are not") {
  // Oracle: round trip.
  const chart::testing::WorkFolder folder;
  std::ostringstream log;
  const BlockStore store(folder.path, 1, log);
  std::vector<Outcome> outcomes(2), back;
  outcomes[0].guards[3] = 17;
  outcomes[0].unguarded = Unguarded::kFailed;
  outcomes[0].time = 0.25;
  outcomes[1].ending = Ending::kFailed;
  outcomes[1].what = "crash: a,b \"c\"\nd";
  store.write(100, outcomes);
  REQUIRE(store.read(100, 2, back));
  CHECK(back[0].guards == outcomes[0].guards);
  CHECK(back[0].unguarded == Unguarded::kFailed);
  CHECK(back[0].time == 0.25);
  CHECK(back[1].ending == Ending::kFailed);
  CHECK(back[1].what == "crash: a b  c  d");
  CHECK_FALSE(store.read(100, 3, back));
  CHECK_FALSE(BlockStore(folder.path, 2, log).read(100, 2, back));
  CHECK(log.str().empty());
}

TEST_CASE("block store: a block that is not whole is named, and is as if it was not there") {
  // Oracle: definition.
  const ScratchFolder folder;
  std::ostringstream ignored;
  std::vector<Outcome> outcomes(2), back;
  outcomes[0].time = 0.25;
  BlockStore(folder.path(), 1, ignored).write(0, outcomes);
  const auto file = std::filesystem::directory_iterator(folder.path())->path().filename().string();
  for (const std::string& text : damaged(text_in(folder / file))) {
    INFO(text);
    folder.write(file, text);
    std::ostringstream log;
    CHECK_FALSE(BlockStore(folder.path(), 1, log).read(0, 2, back));
    CHECK_THAT(log.str(), Catch::Contains(file + ": was "));
  }
}

}  // namespace
}  // namespace palpate::fuzz
