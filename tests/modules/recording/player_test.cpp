#include "modules/recording/player.h"

#include <catch2/catch.hpp>
#include <chrono>
#include <sstream>

#include "modules/bus/memory_bus.h"
#include "modules/core/error.h"
#include "modules/messages/csv.h"
#include "tests/modules/bus/loopback.h"
#include "tests/modules/messages/random_messages.h"
#include "tests/modules/recording/payloads.h"
#include "tests/modules/recording/recording_files.h"
#include "tests/times.h"

namespace palpate::recording {
namespace {

using bus::testing::own_options;
using bus::testing::wait_until;

std::vector<std::string> lines_of(const std::filesystem::path& file) {
  std::istringstream text(text_in(file));
  std::vector<std::string> lines;
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  return lines;
}

}  // namespace

TEST_CASE("player: a replay sends the recorded bytes with the recorded spacing") {
  // Oracle: the recording itself; 20 samples 5 ms apart cannot take less than 95 ms.
  constexpr int kSamples = 20;
  const ScratchFolder folder;
  messages::testing::Random random(11);
  std::vector<TopicSample> recorded;
  for (int i = 0; i < kSamples; ++i) {
    recorded.push_back(raw_sample(bus::kHapticForce,
                                  messages::testing::random_message<HapticForce>(random),
                                  1000 + 5 * i * kMs));
    recorded.push_back(raw_sample(bus::kModuleStatus,
                                  messages::testing::random_message<ModuleStatus>(random),
                                  1000 + 5 * i * kMs));
  }
  SampleFile file(folder / "a.mcap", {});
  for (const TopicSample& sample : recorded) file.add(sample);
  file.close();

  const auto options = own_options();
  bus::DdsBus reader_bus(options), writer_bus(options);
  SessionReader reader(reader_bus);
  SessionWriter writer(writer_bus);
  REQUIRE(wait_until([&] {
    return writer.matched_readers(*bus::find_topic("haptic_force")) == 1 &&
           writer.matched_readers(*bus::find_topic("module_status")) == 1 &&
           reader.matched_writers() == std::tuple_size_v<decltype(bus::kTopics)>;
  }));
  SampleReader recording(folder / "a.mcap");
  const auto begin = std::chrono::steady_clock::now();
  const PlayReport report = play(recording, writer, kNeverStop);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  CHECK(took.count() >= 0.095);
  CHECK(report.samples == recorded.size());
  CHECK(report.refused == 0);
  CHECK(report.duration == Approx(0.095));
  CHECK_FALSE(report.stopped);

  std::map<std::string_view, std::vector<std::vector<std::uint8_t>>> sent, heard;
  for (const TopicSample& sample : recorded) sent[sample.topic->name].push_back(sample.payload);
  std::size_t count = 0;
  REQUIRE(wait_until([&] {
    for (const TopicSample& sample : reader.take_all()) {
      heard[sample.topic->name].push_back(sample.payload);
      ++count;
    }
    return count >= recorded.size();
  }));
  CHECK(heard == sent);
}

namespace {

/// Two organs and a probe; sample i of each at i · 10 ms. The samples' volume and x tell i.
void record_tenths(const std::filesystem::path& file, int count) {
  SampleFile recording(file, {});
  for (int i = 0; i < count; ++i) {
    const std::int64_t time_ns = 1000 + 10 * i * kMs;
    const auto number = static_cast<std::uint64_t>(i + 1);
    for (std::uint32_t organ : {0u, 1u}) {
      NodePositions positions = node_positions(number, 1e-3 * (i + 1), 0);
      positions.organ = organ;
      recording.add(raw_sample(bus::kNodePositions, positions, time_ns));
    }
    recording.add(raw_sample(bus::kProbeState, probe_state(number, 0, 0, Vec3::Zero()), time_ns));
  }
  recording.close();
}

/// Topic, sequence number and key of what a replay writes, in order.
struct Played {
  PlayReport report;
  double took = 0;
  std::vector<std::string> samples;
};

Played played(const std::filesystem::path& file, const PlayOptions& options) {
  bus::MemoryBus bus;
  SessionReader reader(bus);
  SessionWriter writer(bus);
  SampleReader recording(file);
  Played result;
  PlayOptions playing = options;
  const auto begin = std::chrono::steady_clock::now();
  result.report = play(recording, writer, kNeverStop, playing);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  result.took = took.count();
  messages::AnyMessage message;
  for (const TopicSample& sample : reader.take_all()) {
    REQUIRE(sample.topic->type->decode(sample.payload, message) == nullptr);
    result.samples.push_back(std::string(sample.topic->name) + " " +
                             std::to_string(messages::header_of(sample.payload).sequence) + " " +
                             messages::key_text(message));
  }
  std::ranges::sort(result.samples);
  return result;
}

}  // namespace

TEST_CASE("player: from a time on, what held then goes first, then the rest") {
  // Oracle: samples at 0, 10, 20, 30, 40 ms; from 25 ms on the third of each holds.
  const ScratchFolder folder;
  record_tenths(folder / "a.mcap", 5);
  const Played from = played(folder / "a.mcap", {.start = 0.025, .wait_for_step = {}});
  CHECK(from.samples ==
        std::vector<std::string>{"node_positions 3 0", "node_positions 3 1", "node_positions 4 0",
                                 "node_positions 4 1", "node_positions 5 0", "node_positions 5 1",
                                 "probe_state 3 0", "probe_state 4 0", "probe_state 5 0"});
  CHECK(from.report.duration == Approx(0.015));
  CHECK_THROWS_WITH(played(folder / "a.mcap", {.start = 1, .wait_for_step = {}}),
                    Catch::EndsWith("a.mcap: ends before the start asked for"));
  CHECK_NOTHROW(check_start(folder / "a.mcap", 0.025));
  CHECK_THROWS_WITH(check_start(folder / "a.mcap", 1),
                    Catch::EndsWith("s long and ends before the start asked for, --start 1"));
}

TEST_CASE("player: who listens to a replay counts no gaps that its recording had") {
  // Oracle: the reader's own count of gaps; of every third sample, and of two writers that count
  // for themselves.
  const ScratchFolder folder;
  SampleFile recording(folder / "a.mcap", {});
  for (std::uint64_t i = 0; i < 20; ++i) {
    TopicSample sample = raw_sample(bus::kProbeState, probe_state(1 + 3 * i, 0, 0, Vec3::Zero()),
                                    1000 + std::int64_t(i) * kMs);
    sample.writer[0] = i % 2;
    recording.add(sample);
  }
  recording.close();
  const auto gaps = [&](bool counts_anew) {
    bus::MemoryBus bus;
    auto reader = bus.reader(bus::kProbeState, bus::Keep::kBacklog);
    SessionWriter writer(bus);
    SampleReader played(folder / "a.mcap");
    play(played, writer, kNeverStop, {.wait_for_step = {}, .counts_anew = counts_anew});
    ProbeState state;
    std::uint64_t count = 0;
    while (reader.take(state)) ++count;
    CHECK(count == 20);
    return reader.statistics().dropped;
  };
  CHECK(gaps(true) == 0);
  CHECK(gaps(false) > 0);
}

TEST_CASE("player: the rate stretches the spacing") {
  // Oracle: 40 ms of recording at a quarter of its speed cannot take less than 160 ms.
  const ScratchFolder folder;
  record_tenths(folder / "a.mcap", 5);
  const Played slow = played(folder / "a.mcap", {.rate = 0.25, .wait_for_step = {}});
  CHECK(slow.took >= 0.16);
  CHECK(slow.samples.size() == 15);
  CHECK(slow.report.duration == Approx(0.04));
}

TEST_CASE("player: in steps, each waits for its picture to be let go") {
  // Oracle: the third picture is not let go: three node_positions are out and nothing behind them.
  const ScratchFolder folder;
  record_tenths(folder / "a.mcap", 5);
  int asked = 0;
  const Played stepped =
      played(folder / "a.mcap", {.rate = 1e-6, .wait_for_step = [&] { return ++asked < 3; }});
  CHECK(stepped.report.stopped);
  CHECK(stepped.samples == std::vector<std::string>{"node_positions 1 0", "node_positions 1 1",
                                                    "node_positions 2 0", "probe_state 1 0"});
}

TEST_CASE("player: stops when asked to") {
  // Oracle: the second sample lies an hour ahead; stopping must not wait for it.
  const ScratchFolder folder;
  SampleFile file(folder / "a.mcap", {});
  const auto state = probe_state(1, 0, 0, Vec3::Zero());
  file.add(raw_sample(bus::kProbeState, state, 0));
  file.add(raw_sample(bus::kProbeState, state, 3600 * 1000 * kMs));
  file.close();
  bus::MemoryBus bus;
  SessionWriter writer(bus);
  SampleReader recording(folder / "a.mcap");
  int asked = 0;
  const PlayReport report = play(recording, writer, [&] { return ++asked > 3; });
  CHECK(report.stopped);
  CHECK(report.samples == 1);
}

TEST_CASE("player: extracts one trajectory per probe in session time") {
  // Oracle: rows written by hand; numbers chosen to be exact in decimal and binary.
  const ScratchFolder folder;
  SampleFile file(folder / "a.mcap", {});
  for (int i = 0; i < 3; ++i) {
    ProbeState state = probe_state(1, i * 500 * kMs, 0, {0.25 * i, 0, -1});
    state.pose.rotation = Quat(0, 1, 0, 0);  // half a turn about x
    file.add(raw_sample(bus::kProbeState, state, i));
    file.add(raw_sample(bus::kProbeState, probe_state(1, i * 500 * kMs, 2, {0, 0, 1}), i));
    file.add(raw_sample(bus::kProbeInput, probe_state(1, 0, 5, Vec3::Zero()), i));
  }
  file.close();
  std::vector<std::string> warnings;
  const auto trajectories = extract_probe_trajectories(folder / "a.mcap", folder / "out", warnings);
  CHECK(warnings.empty());
  REQUIRE(trajectories.size() == 2);
  CHECK(trajectories[0].probe == 0);
  CHECK(trajectories[1].probe == 2);
  CHECK(trajectories[0].rows == 3);
  CHECK(trajectories[0].duration == 1);
  CHECK(trajectories[0].file == folder / "out/probe_0.csv");
  CHECK(lines_of(trajectories[0].file) ==
        std::vector<std::string>{"t,x,y,z,qx,qy,qz,qw", "0,0,0,-1,1,0,0,0", "0.5,0.25,0,-1,1,0,0,0",
                                 "1,0.5,0,-1,1,0,0,0"});
}

TEST_CASE("player: before the start and while paused the newest pose of a time holds") {
  // Oracle: times must increase strictly; the last of equal ones by hand.
  const ScratchFolder folder;
  SampleFile file(folder / "a.mcap", {});
  const std::int64_t times_ms[] = {0, 0, 250, 250, 500};
  for (int i = 0; i < 5; ++i) {
    file.add(
        raw_sample(bus::kProbeState, probe_state(1, times_ms[i] * kMs, 0, {1.0 * i, 0, 0}), i));
  }
  file.close();
  std::vector<std::string> warnings;
  const auto trajectories = extract_probe_trajectories(folder / "a.mcap", folder / "out", warnings);
  const auto lines = lines_of(trajectories.at(0).file);
  REQUIRE(lines.size() == 4);
  CHECK(lines[1] == "0,1,0,0,0,0,0,1");
  CHECK(lines[2] == "0.25,3,0,0,0,0,0,1");
}

TEST_CASE("player: after a reset only the last stretch counts, torn and invalid are told") {
  // Oracle: rows and warnings by hand.
  const ScratchFolder folder;
  const auto name = folder / "a.mcap";
  {
    SampleFile file(name, {});
    for (const int ms : {0, 250, 500, 0, 125}) {
      file.add(raw_sample(bus::kProbeState, probe_state(1, ms * kMs, 0, {1, 0, 0}), ms));
    }
    auto broken = raw_sample(bus::kProbeState, probe_state(1, 0, 0, {1, 0, 0}), 600);
    broken.payload.resize(40);
    file.add(broken);
    file.end_chunk();
    file.flush();
  }
  std::vector<std::string> warnings;
  const auto trajectories = extract_probe_trajectories(name, folder / "out", warnings);
  CHECK(trajectories.at(0).rows == 2);
  CHECK(trajectories.at(0).duration == 0.125);
  REQUIRE(warnings.size() == 3);
  CHECK_THAT(warnings[0], Catch::Contains("not closed by its writer"));
  CHECK_THAT(warnings[1], Catch::EndsWith("1 invalid probe_state samples left out"));
  CHECK_THAT(warnings[2],
             Catch::EndsWith("probe_0: only the motion after the last of 1 resets is used"));
}

TEST_CASE("player: a recording without probes cannot drive a scene") {
  // Oracle: the message the rule must give.
  const ScratchFolder folder;
  SampleFile(folder / "a.mcap", {}).close();
  std::vector<std::string> warnings;
  CHECK_THROWS_WITH(extract_probe_trajectories(folder / "a.mcap", folder / "out", warnings),
                    Catch::EndsWith("a.mcap: holds no motion of a probe (topic probe_state)"));
}

}  // namespace palpate::recording
