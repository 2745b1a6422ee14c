#include "modules/recording/inspect.h"

#include <catch2/catch.hpp>
#include <set>
#include <sstream>

#include "modules/core/error.h"
#include "tests/file_size_limit.h"
#include "tests/modules/recording/payloads.h"
#include "tests/modules/recording/recording_files.h"
#include "tests/times.h"

namespace palpate::recording {
namespace {

constexpr std::int64_t kStart = 5'000'000'000;

// Node positions every 4 ms with two of them missing, two modules' statuses, one broken sample.
void write_session(const std::filesystem::path& file, bool close = true) {
  SampleFile writer(file, {.domain = 3, .session = "bench"});
  SceneDescription scene;
  scene.header = {1, 0, 1};
  scene.name = "ball_squeeze";
  scene.digest = "00ff";
  writer.add(raw_sample(bus::kScene, scene, kStart));
  for (const std::uint64_t sequence : {10, 11, 14, 15}) {
    NodePositions nodes = node_positions(sequence, 1e-3, 100);
    nodes.header.source_time_ns = kStart + static_cast<std::int64_t>(sequence) * 4 * kMs;
    writer.add(raw_sample(bus::kNodePositions, nodes, nodes.header.source_time_ns + kMs / 4));
  }
  std::uint8_t id = 0;
  for (const char* module : {"haptics", "../collision"}) {
    ModuleStatus status;
    status.header = {1, 0, 1};
    status.module = module;
    status.inputs = {{"probe_state", 0.5, 0, 10, 1, 0}, {"contacts", 0.25, 0, 20, 0, 2}};
    writer.add(raw_sample(bus::kModuleStatus, status, kStart + 70 * kMs, ++id));
  }
  HapticForce force;
  force.header = {1, 0, 1};
  TopicSample broken = raw_sample(bus::kHapticForce, force, kStart + 80 * kMs);
  broken.payload.resize(30);
  writer.add(broken);
  writer.end_chunk();
  writer.flush();
  if (close) writer.close();
}

}  // namespace

TEST_CASE("inspect: counts samples, bytes, rates, gaps and writers of each topic") {
  // Oracle: counted by hand from write_session().
  const ScratchFolder folder;
  write_session(folder / "a.mcap");
  const RecordingSummary summary = summarize(folder / "a.mcap");
  CHECK_FALSE(summary.torn);
  CHECK(summary.session.at("session") == "bench");
  CHECK(summary.scene.at("name") == "ball_squeeze");
  CHECK(summary.first_ns == kStart);
  CHECK(summary.last_ns == kStart + 80 * kMs);
  REQUIRE(summary.topics.size() == 4);

  const TopicSummary& force = summary.topics[0];
  CHECK(force.topic->name == "haptic_force");
  CHECK(force.samples == 1);
  CHECK(force.invalid == 1);
  CHECK(force.rate_hz() == 0);

  const TopicSummary& status = summary.topics[1];
  CHECK(status.topic->name == "module_status");
  CHECK(status.writers == 2);
  CHECK(status.missing == 0);

  const TopicSummary& nodes = summary.topics[2];
  CHECK(nodes.topic->name == "node_positions");
  CHECK(nodes.samples == 4);
  CHECK(nodes.bytes == 4 * cdr_of(node_positions(1, 1e-3, 1)).size());
  CHECK(nodes.missing == 2);
  CHECK(nodes.invalid == 0);
  CHECK(nodes.longest_spacing_ns == 12 * kMs);
  CHECK(nodes.rate_hz() == Approx(3 / 0.020));  // three spacings in 20 ms
}

TEST_CASE("inspect: the table names what matters on one screen") {
  // Oracle: the row of node_positions, written by hand.
  const ScratchFolder folder;
  write_session(folder / "a.mcap");
  std::ostringstream out;
  print_summary(summarize(folder / "a.mcap"), out);
  using Catch::Contains;
  CHECK_THAT(out.str(), Contains("a.mcap, 0.0 MB, whole\n"));
  CHECK_THAT(out.str(), Contains("session    bench in domain 3, recorded 20"));
  CHECK_THAT(out.str(), Contains("scene      ball_squeeze, digest 00ff\n"));
  CHECK_THAT(out.str(), Contains("duration   0.080 s\n"));
  CHECK_THAT(out.str(), Contains("\nnode_positions   NodePositions            4    150.0"));
  std::istringstream lines(out.str());
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("recording", 0) != 0) CHECK(line.size() <= 120);
  }
}

TEST_CASE("inspect: says what recording took, and that gaps of a thinned topic are no loss") {
  // Oracle: by hand: 3 MB in 20 s are 9 a minute, 0.5 s of 20 are 2.5 %.
  CHECK(cost_text({{"wall_s", "20"}, {"processor_s", "0.5"}, {"samples_lost", "7"}}, 3'000'000) ==
        "9.0 MB a minute, 2.5 % of a core, 7 samples lost");
  CHECK(cost_text({}, 3'000'000) == "what it took is not known");
  const ScratchFolder folder;
  SampleFile writer(folder / "a.mcap", {}, Clocks::now(), TopicSelection({"node_positions=10"}));
  for (const std::uint64_t sequence : {1, 2, 3}) {
    const auto time_ns = static_cast<std::int64_t>(sequence * 60 * kMs);
    writer.add(raw_sample(bus::kNodePositions, node_positions(sequence, 1e-3, 0), time_ns));
  }
  writer.add_metadata({kCostMetadata, {{"wall_s", "20"}, {"processor_s", "0.5"}}});
  writer.close();
  const RecordingSummary summary = summarize(folder / "a.mcap");
  REQUIRE(summary.topics.size() == 1);
  CHECK(summary.topics[0].samples == 2);
  CHECK(summary.topics[0].missing == 0);
  CHECK(summary.topics[0].thinned);
  std::ostringstream out;
  print_summary(summary, out);
  CHECK_THAT(out.str(), Catch::Contains("\nrecorder   ") && Catch::Contains("thinned"));
}

TEST_CASE("inspect: what a writer said between two parts of a recording is missing") {
  // Oracle: by hand: 1 to 3 in the first part, 8 and 9 of the same writer in the second.
  const ScratchFolder folder;
  const auto write = [](const std::filesystem::path& file, std::uint64_t first, std::uint64_t last,
                        std::int64_t start_unix) {
    SampleFile part(file, {.session = "bench"}, {0, start_unix});
    for (std::uint64_t i = first; i <= last; ++i) {
      part.add(raw_sample(bus::kNodePositions, node_positions(i, 1e-3, 1), std::int64_t(i) * kMs));
    }
    part.close();
  };
  write(folder / "a.mcap", 1, 3, 1'000'000'000);
  write(folder / "a.part2.mcap", 8, 9, 2'000'000'000);
  const RecordingSummary summary = summarize(folder / "a.mcap");
  CHECK(summary.parts == 2);
  REQUIRE(summary.topics.size() == 1);
  CHECK(summary.topics[0].missing == 4);
  CHECK(summary.topics[0].writers == 1);
}

TEST_CASE("inspect: of a lockstep recording says that its times are simulated") {
  // Oracle: the text by hand.
  const ScratchFolder folder;
  SampleFile file = SampleFile::of_lockstep(folder / "a.mcap");
  file.add(raw_sample(bus::kNodePositions, node_positions(1, 1e-3, 1), kMs));
  file.close();
  std::ostringstream out;
  print_summary(summarize(folder / "a.mcap"), out);
  CHECK_THAT(out.str(), Catch::Contains("in lockstep, or in one process: times are simulated\n"));
  CHECK_THAT(out.str(), !Catch::Contains("?"));
}

TEST_CASE("inspect: an empty recording has no topics and no scene") {
  // Oracle: by hand.
  const ScratchFolder folder;
  SampleFile(folder / "a.mcap", {}).close();
  const RecordingSummary summary = summarize(folder / "a.mcap", folder / "csv");
  CHECK(summary.topics.empty());
  CHECK(summary.first_ns == 0);
  std::ostringstream out;
  print_summary(summary, out);
  CHECK_THAT(out.str(), Catch::Contains("scene      none was heard\n"));
}

TEST_CASE("inspect: a torn recording says so and counts what is whole") {
  // Oracle: the same file closed and not closed.
  const ScratchFolder folder;
  write_session(folder / "torn.mcap", false);
  const RecordingSummary summary = summarize(folder / "torn.mcap");
  CHECK(summary.torn);
  REQUIRE(summary.warnings.size() == 1);
  CHECK_THAT(summary.warnings[0], Catch::Contains("not closed by its writer"));
  CHECK(summary.topics.size() == 4);
  std::ostringstream out;
  print_summary(summary, out);
  CHECK_THAT(out.str(), Catch::Contains("torn: ends at its last whole record"));
}

TEST_CASE("inspect: writes one CSV file per topic and key") {
  // Oracle: rows written by hand.
  const ScratchFolder folder;
  write_session(folder / "a.mcap");
  summarize(folder / "a.mcap", folder / "csv");
  CHECK(text_in(folder / "csv/node_positions_0.csv") ==
        "time_s,sim_time_s,latency_s,sequence,generation,volume_m3,target_volume_m3,"
        "pressure_pa,kinetic_energy_j,elastic_energy_j,organ_contacts,node_count\n"
        "0.04025,0.04,0.00025,10,0,0.001,0.001,100,0,0,0,1\n"
        "0.04425,0.044,0.00025,11,0,0.001,0.001,100,0,0,0,1\n"
        "0.05625,0.056,0.00025,14,0,0.001,0.001,100,0,0,0,1\n"
        "0.06025,0.06,0.00025,15,0,0.001,0.001,100,0,0,0,1\n");
  const std::string inputs = text_in(folder / "csv/module_inputs_haptics.csv");
  CHECK_THAT(inputs, Catch::StartsWith(
                         "time_s,sim_time_s,latency_s,sequence,topic,age_s,age_error_s,received,"
                         "dropped,rejected\n0.07,0,"));
  CHECK_THAT(inputs, Catch::Contains(",probe_state,0.5,0,10,1,0\n"));
  CHECK_THAT(inputs, Catch::EndsWith(",contacts,0.25,0,20,0,2\n"));
  CHECK(std::filesystem::exists(folder / "csv/scene.csv"));
  CHECK_THROWS_WITH(
      summarize(folder / "a.mcap", folder / "a.mcap"),
      Catch::Contains("a.mcap': must be a folder that can be written (Not a directory)"));
  CHECK(std::filesystem::exists(folder / "csv/module_status_haptics.csv"));
  CHECK_FALSE(std::filesystem::exists(folder / "csv/haptic_force_0.csv"));  // none was valid
}

TEST_CASE("inspect: tables of another recording are refused, or replaced all") {
  // Oracle: the names of files; a person's own table stays.
  const ScratchFolder folder;
  write_session(folder / "two.mcap");
  SampleFile one(folder / "one.mcap", {});
  one.add(raw_sample(bus::kProbeState, probe_state(1, 0, 0, Vec3::Zero()), 1));
  one.close();
  summarize(folder / "two.mcap", folder / "csv");
  folder.write("csv/notes.csv", "time_s,note\n");
  CHECK_THROWS_WITH(summarize(folder / "one.mcap", folder / "csv"),
                    Catch::Contains("csv': holds tables of a recording already (") &&
                        Catch::EndsWith("give another folder, or --overwrite"));
  summarize(folder / "one.mcap", folder / "csv", true);
  std::set<std::string> left;
  for (const auto& file : std::filesystem::directory_iterator(folder / "csv")) {
    left.insert(file.path().filename().string());
  }
  CHECK(left == std::set<std::string>{"notes.csv", "probe_state_0.csv"});
}

TEST_CASE("inspect: a folder for CSV that no name can be is bad input") {
  // Oracle: ELOOP and ENAMETOOLONG, as strerror has them.
  const ScratchFolder folder;
  write_session(folder / "a.mcap");
  std::filesystem::create_symlink(folder / "loop", folder / "loop");
  for (const auto& [name, why] : std::vector<std::pair<std::string, std::string>>{
           {"loop", "Too many levels of symbolic links"},
           {std::string(300, 'n'), "File name too long"}}) {
    CHECK_THROWS_WITH(summarize(folder / "a.mcap", folder / name),
                      Catch::StartsWith("--csv '") && Catch::Contains(why));
    CHECK_THROWS_AS(summarize(folder / "a.mcap", folder / name), InputError);
  }
}

TEST_CASE("inspect: a module's name cannot lead out of the CSV folder") {
  // Oracle: by hand: every letter that is not plain becomes an underscore.
  const ScratchFolder folder;
  write_session(folder / "a.mcap");
  summarize(folder / "a.mcap", folder / "csv");
  CHECK(std::filesystem::exists(folder / "csv/module_status____collision.csv"));
}

TEST_CASE("inspect: on a full disk no table is left, nor a folder that was not there") {
  // Oracle: the folder; a limit on the size of files fails where a full disk does.
  const ScratchFolder folder;
  write_session(folder / "a.mcap");
  std::filesystem::create_directory(folder / "there");
  {
    const FileSizeLimit limit(20);
    for (const char* name : {"new", "there"}) {
      CHECK_THROWS_WITH(summarize(folder / "a.mcap", folder / name),
                        Catch::EndsWith(": File too large"));
    }
  }
  CHECK_FALSE(std::filesystem::exists(folder / "new"));
  CHECK(std::filesystem::is_empty(folder / "there"));
  summarize(folder / "a.mcap", folder / "new");
  CHECK(std::filesystem::exists(folder / "new/scene.csv"));
}

}  // namespace palpate::recording
