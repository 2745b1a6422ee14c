#include "modules/recording/space_watch.h"

#include <catch2/catch.hpp>

#include "tests/modules/recording/recording_files.h"

namespace palpate::recording {

TEST_CASE("space watch: says it early and once, and when the room is used up") {
  // Oracle: 1 MiB a second into 1 GiB that others share: 768 MiB are this recording's. Ten minutes
  // before they are full, after 168 s, it is said; the last is at 768 s.
  const std::uint64_t mebibyte = 1u << 20;
  double now = 0;
  SpaceWatch watch([&] { return std::uint64_t(1024 - now) * mebibyte; });
  std::vector<std::pair<double, std::string>> said;
  for (; now < 900; now += 0.25) {
    const std::string word = watch.look(100 + now, std::uint64_t(now * double(mebibyte)));
    if (!word.empty()) said.emplace_back(now, word);
  }
  REQUIRE(said.size() == 2);
  CHECK(said[0].first == Approx(169).margin(1));
  CHECK_THAT(said[0].second, Catch::Contains("left on the disk: room for 9 min 5"));
  CHECK(said[1].first == Approx(769).margin(1));
  CHECK_THAT(said[1].second, Catch::Contains("the recording ends here, whole"));
  CHECK(watch.full());
}

TEST_CASE("space watch: looks at the disk of the recording") {
  // Oracle: a disk that this test runs on has room; the kernel's process files have none.
  const ScratchFolder folder;
  SpaceWatch here(folder / "a.mcap");
  here.look(0, 0);
  CHECK(here.full() == (std::filesystem::space(folder.path()).available < kSpaceKept));
  SpaceWatch full(std::filesystem::path("/proc/a.mcap"));
  const std::string kept = "0 MiB left on the disk, of which 256 MiB are kept free";
  CHECK(full.look(0, 0) == kept + ": the recording ends here, whole");
  CHECK_THROWS_WITH(check_recording_space("/proc/a.mcap"),
                    "/proc/a.mcap: cannot be recorded to: " + kept);
}

}  // namespace palpate::recording
