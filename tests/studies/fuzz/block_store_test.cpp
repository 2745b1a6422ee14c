#include "studies/fuzz/block_store.h"

#include <catch2/catch.hpp>

#include "tests/studies/chart/folders.h"

namespace palpate::fuzz {
namespace {

TEST_CASE("block store: what was written is read back, blocks of other seeds are not") {
  // Oracle: round trip.
  const chart::testing::WorkFolder folder;
  const BlockStore store(folder.path, 1);
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
  CHECK_FALSE(BlockStore(folder.path, 2).read(100, 2, back));
}

}  // namespace
}  // namespace palpate::fuzz
