#include "modules/recording/writing_thread.h"

#include <catch2/catch.hpp>
#include <stdexcept>

#include "tests/modules/recording/payloads.h"

namespace palpate::recording {
namespace {

TopicSample numbered_pose(std::uint64_t number) {
  return raw_sample(bus::kProbeState, probe_state(number, 0, 0, Vec3::Zero()),
                    std::int64_t(number));
}

}  // namespace

TEST_CASE("writing thread: writes all in order, though it stands still for a while") {
  // Oracle: the numbers of what was added.
  std::vector<std::int64_t> written;
  std::mutex disk;
  WritingThread thread({[&](const TopicSample& sample) {
                          const std::lock_guard stands(disk);
                          written.push_back(sample.received_time_ns);
                        },
                        [] {}});
  constexpr int kSamples = 20'000;
  {
    const std::lock_guard stands(disk);
    for (int i = 1; i <= kSamples; ++i) REQUIRE(thread.add(numbered_pose(std::uint64_t(i))));
  }
  thread.finish();
  REQUIRE(written.size() == kSamples);
  for (int i = 0; i < kSamples; ++i) REQUIRE(written[std::size_t(i)] == i + 1);
}

TEST_CASE("writing thread: what would be too much to wait is refused") {
  // Oracle: the bound given: three payloads, while the disk stands.
  std::mutex disk;
  std::atomic<int> written = 0;
  const TopicSample sample = numbered_pose(1);
  disk.lock();
  WritingThread thread(
      {[&](const TopicSample&) { ++written; }, [&] { const std::lock_guard stands(disk); }},
      3 * sample.payload.size());
  int taken = 0;
  for (int i = 0; i < 100; ++i) taken += thread.add(sample) ? 1 : 0;
  disk.unlock();
  thread.finish();
  CHECK(written == taken);
  CHECK(taken >= 3);
  CHECK(taken <= 6);  // the thread may have taken one batch before it stood
}

TEST_CASE("writing thread: what the disk says reaches whoever adds, and nothing more is taken") {
  // Oracle: the exception thrown by the job.
  WritingThread thread({[](const TopicSample&) { throw std::runtime_error("disk full"); }, [] {}});
  REQUIRE(thread.add(numbered_pose(1)));
  CHECK_THROWS_WITH(thread.finish(), "disk full");
  CHECK_FALSE(thread.add(numbered_pose(2)));
  CHECK_THROWS_WITH(thread.check(), "disk full");
}

}  // namespace palpate::recording
