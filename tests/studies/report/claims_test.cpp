#include "studies/report/claims.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <csignal>
#include <fstream>
#include <map>

#include "modules/core/error.h"
#include "tests/scratch_folder.h"

using namespace palpate;
using namespace palpate::report;

namespace {

/// Points that note in the folder who measured them, a line each time.
std::vector<report::Point> noted_points(const std::filesystem::path& folder, int count,
                                        useconds_t takes) {
  std::vector<report::Point> points;
  for (int i = 0; i < count; ++i) {
    const auto stored = folder / ("point-" + std::to_string(i));
    const auto tally = folder / ("tally-" + std::to_string(i));
    points.push_back({"point-" + std::to_string(i),
                      [stored] { return std::filesystem::exists(stored); },
                      [=] {
                        std::ofstream(tally, std::ios::app) << ::getpid() << '\n';
                        ::usleep(takes);
                        std::ofstream(stored) << i;
                      }});
  }
  return points;
}

/// A process that measures as a shard.
pid_t shard_process(const std::filesystem::path& folder, std::size_t index, std::size_t count,
                    int points, useconds_t takes) {
  const pid_t child = ::fork();
  if (child != 0) return child;
  Claims claims(folder / "claims", Shard{index, count});
  measure_points(noted_points(folder, points, takes), claims);
  ::_exit(0);
}

void age(const std::filesystem::path& file, long seconds) {
  struct stat status {};
  REQUIRE(::stat(file.c_str(), &status) == 0);
  status.st_mtim.tv_sec -= seconds;
  const timespec times[2] = {status.st_mtim, status.st_mtim};
  REQUIRE(::utimensat(AT_FDCWD, file.c_str(), times, 0) == 0);
}

}  // namespace

TEST_CASE("claims: I/N is read strictly") {
  // Oracle: the stated form.
  CHECK(shard_from("3/8").index == 3);
  CHECK(shard_from("3/8").count == 8);
  for (const char* text :
       {"0/2", "3/2", "1", "/", "1/", "a/b", "1/2/3", "-1/2", "1/200000", "1.5/2"}) {
    CHECK_THROWS_WITH(shard_from(text), Catch::Contains("must be I/N with 1 <= I <= N"));
  }
}

TEST_CASE("claims: of many processes each point is measured by one, and all points by some") {
  // Oracle: the points' own tally.
  const ScratchFolder folder;
  std::vector<pid_t> shards;
  for (std::size_t i = 1; i <= 6; ++i)
    shards.push_back(shard_process(folder.path(), i, 6, 60, 2000));
  for (const pid_t shard : shards) {
    int status = 0;
    REQUIRE(::waitpid(shard, &status, 0) == shard);
    CHECK(status == 0);
  }
  std::map<std::string, int> by_whom;
  for (int i = 0; i < 60; ++i) {
    const std::string tally = text_in(folder / ("tally-" + std::to_string(i)));
    CHECK(std::count(tally.begin(), tally.end(), '\n') == 1);
    ++by_whom[tally];
  }
  CHECK(by_whom.size() > 1);  // they did share
}

TEST_CASE("claims: a dead run's point is taken over after a while, by one, and not before") {
  // Oracle: a process killed while it measures; its claim is made older by hand.
  const ScratchFolder folder;
  const pid_t dead = shard_process(folder.path(), 1, 2, 1, 60'000'000);
  while (text_in(folder / "tally-0").empty()) ::usleep(1000);
  ::kill(dead, SIGKILL);
  ::waitpid(dead, nullptr, 0);
  const auto points = noted_points(folder.path(), 1, 0);
  {
    Claims claims(folder / "claims", Shard{2, 2});
    const Share share = measure_points(points, claims);
    CHECK(share.elsewhere == 1);
    CHECK(share.measured == 0);
  }
  age(folder / "claims/point-0.claim", kTakenOverAfter.count() + 5);
  Claims first(folder / "claims", Shard{1, 2}), second(folder / "claims", Shard{2, 2});
  CHECK(first.take("point-0"));
  CHECK_FALSE(second.take("point-0"));
  // And one that lives says so.
  Claims watched(folder / "watched", Shard{1, 1}), other(folder / "watched", Shard{1, 1});
  CHECK(watched.take("a"));
  age(folder / "watched/a.claim", kTakenOverAfter.count() - 60);
  CHECK_FALSE(other.take("a"));
}

TEST_CASE(
    "claims: a run that is stopped gives back its point, and one without a shard claims nothing") {
  // Oracle: the files that are there.
  struct Ended {};
  const ScratchFolder folder;
  const std::vector<report::Point> points{{"a", [] { return false; }, [] { throw Ended{}; }}};
  try {
    Claims claims(folder / "claims", Shard{1, 2});
    measure_points(points, claims);
    FAIL("it did not end");
  } catch (const Ended&) {
  }
  CHECK_FALSE(std::filesystem::exists(folder / "claims/a.claim"));
  Claims plain(folder / "none", {});
  CHECK(plain.take("a"));
  CHECK(plain.take("a"));
  CHECK_FALSE(std::filesystem::exists(folder / "none"));
  CHECK(measure_points({}, plain).measured == 0);
}
