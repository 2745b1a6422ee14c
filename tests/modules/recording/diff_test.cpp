#include "modules/recording/diff.h"

#include <catch2/catch.hpp>
#include <fstream>
#include <limits>
#include <span>
#include <sstream>

#include "modules/core/error.h"
#include "modules/core/units.h"
#include "modules/recording/commands.h"
#include "tests/file_size_limit.h"
#include "tests/modules/recording/payloads.h"
#include "tests/modules/recording/recording_files.h"

namespace palpate::recording {
namespace {

struct Changes {
  std::uint64_t other_pressure_at = 0;  ///< sample of organ 1 from which its pressure is 0.5 more
  std::uint64_t samples = 10;           ///< of each organ
  bool other_writer = false;
};

std::filesystem::path record(const std::filesystem::path& file, const Changes& changes) {
  SampleFile recording(file, {});
  for (std::uint64_t i = 1; i <= changes.samples; ++i) {
    for (std::uint32_t organ = 0; organ < 2; ++organ) {
      NodePositions nodes = node_positions(i, 1e-3, 10);
      nodes.organ = organ;
      const bool differs = changes.other_pressure_at > 0 && i >= changes.other_pressure_at;
      if (organ == 1 && differs) nodes.pressure += 0.5;
      if (organ == 1 && differs && i == 8) nodes.positions[2] += 0.25f;
      recording.add(raw_sample(bus::kNodePositions, nodes, long(i), changes.other_writer ? 2 : 1));
    }
  }
  recording.close();
  return file;
}

}  // namespace

TEST_CASE("diff: what is in one recording alone does not fill the memory") {
  // Oracle: the bound given; 200 samples of one organ have no partner in the other.
  const ScratchFolder folder;
  const auto a = record(folder / "a.mcap", {.samples = 200});
  const auto b = record(folder / "b.mcap", {.samples = 1});
  CHECK_THROWS_WITH(compare({a, b}, 10'000), Catch::Contains("are in one of them alone"));
  CHECK_FALSE(compare({a, b}).equal());
  CHECK(compare({a, a}, 10'000).equal());
}

TEST_CASE("diff: a recording equals itself, whoever wrote it and whenever it arrived") {
  // Oracle: the same samples by another writer.
  const ScratchFolder folder;
  const auto a = record(folder / "a.mcap", {});
  const auto b = record(folder / "b.mcap", {.other_writer = true});
  const RecordingDifference difference = compare({.a = a, .b = b});
  CHECK(difference.equal());
  CHECK_FALSE(difference.first);
  CHECK(difference.topics.at("node_positions").compared == 20);
}

TEST_CASE("diff: names the first tick, key, field and values that differ") {
  // Oracle: the pressure of organ 1, 0.5 Pa more from its sample 6 on, at 6 · 4 ms; one coordinate
  // 0.25 m off in sample 8.
  const ScratchFolder folder;
  const auto a = record(folder / "a.mcap", {});
  const auto b = record(folder / "b.mcap", {.other_pressure_at = 6});
  const RecordingDifference difference =
      compare({.a = a, .b = b, .csv = folder / "differences.csv"});
  CHECK_FALSE(difference.equal());
  REQUIRE(difference.first);
  CHECK(difference.first->sim_time_ns == 24'000'000);
  CHECK(difference.first->topic == "node_positions");
  CHECK(difference.first->key == "1");
  CHECK(difference.first->field == "pressure_pa");
  CHECK(difference.first->a == "10");
  CHECK(difference.first->b == "10.5");
  const TopicDifference& topic = difference.topics.at("node_positions");
  CHECK(topic.differing == 5);
  REQUIRE(topic.fields.size() == 2);
  CHECK(topic.fields.at("pressure_pa").samples == 5);
  CHECK(topic.fields.at("pressure_pa").largest == 0.5);
  CHECK(topic.fields.at("positions_m").samples == 1);
  CHECK(topic.fields.at("positions_m").largest == Approx(0.25));
  CHECK(topic.fields.at("positions_m").largest_sim_time_ns == 32'000'000);
  const std::string csv = text_in(folder / "differences.csv");
  CHECK(std::count(csv.begin(), csv.end(), '\n') == 1 + 6);
  CHECK(csv.find("0.024,node_positions,1,pressure_pa,0.5\n") != std::string::npos);
}

TEST_CASE("diff: a table that cannot be finished is not there, and replaces nothing but its like") {
  // Oracle: the folder, and the messages by hand; a limit on the size of files fails where a full
  // disk does.
  const ScratchFolder folder;
  const auto a = record(folder / "a.mcap", {.samples = 200});
  const auto b = record(folder / "b.mcap", {.other_pressure_at = 1, .samples = 200});
  const auto table = folder / "t.csv";
  {
    const FileSizeLimit limit(600);
    CHECK_THROWS_WITH(compare({.a = a, .b = b, .csv = table}),
                      Catch::StartsWith("cannot write " + table.string()));
  }
  CHECK_THROWS_AS(compare({a, b, {}, table}, 100), InputError);  // more waits than may
  CHECK(folder.file_count() == 2);
  CHECK_NOTHROW(compare({.a = a, .b = b, .csv = table}));
  CHECK_NOTHROW(compare({.a = a, .b = b, .csv = table}));
  folder.write("scene.yaml", "palpate_scene: 1");
  CHECK_THROWS_WITH(compare({.a = a, .b = b, .csv = folder / "scene.yaml"}),
                    (folder / "scene.yaml").string() +
                        ": is no table of differences, and is not replaced by one");
  CHECK(text_in(folder / "scene.yaml") == "palpate_scene: 1");
}

TEST_CASE("diff: of texts it says that they differ, not by how much") {
  // Oracle: two scenes that differ in their names and digests.
  const ScratchFolder folder;
  const auto record_scene = [&](const std::string& name) {
    const auto file = folder / (name + ".mcap");
    SampleFile recording(file, {});
    SceneDescription scene;
    scene.name = name;
    scene.header = {1, 0, 1};
    scene.digest = "0123456789abcde" + name.substr(2, 1);
    scene.resolved_text = "palpate_scene: 1\n";
    recording.add(raw_sample(bus::kScene, scene, 1, 1));
    recording.close();
    return file;
  };
  const RecordingDifference difference = compare(
      {.a = record_scene("one"), .b = record_scene("other"), .csv = folder / "differences.csv"});
  std::ostringstream said;
  print_difference(difference, said);
  CHECK_THAT(said.str(), Catch::Contains("  name: 1 samples, another text at"));
  std::ostringstream rows;
  rows << std::ifstream(folder / "differences.csv").rdbuf();
  CHECK_THAT(rows.str(), Catch::Contains(",scene,,name,text\n"));
}

TEST_CASE("diff: a scene of the same content is the same, whatever it and its files are called") {
  // Oracle: the digest, and the text that tells two such scenes apart.
  const ScratchFolder folder;
  const auto record_scene = [&](const std::string& name, const std::string& digest) {
    const auto file = folder / (name + ".mcap");
    SampleFile recording = SampleFile::of_lockstep(file);
    SceneDescription scene;
    scene.header = {1, 0, 1};
    scene.name = name;
    scene.digest = digest;
    scene.resolved_text = "file: " + name;
    recording.add(raw_sample(bus::kScene, scene, 1, 1));
    recording.close();
    return file;
  };
  const auto a = record_scene("a", "0123456789abcdef"),
             copy = record_scene("b", "0123456789abcdef");
  CHECK(compare({a, copy}).equal());
  const auto other = compare({a, record_scene("c", "0123456789abcdee")});
  CHECK(other.topics.at("scene").fields.size() == 3);
}

TEST_CASE("diff: samples that one recording lacks are counted") {
  // Oracle: 10 and 7 samples of two organs.
  const ScratchFolder folder;
  const auto a = record(folder / "a.mcap", {});
  const auto b = record(folder / "b.mcap", {.samples = 7});
  const RecordingDifference difference = compare({.a = a, .b = b});
  CHECK_FALSE(difference.equal());
  CHECK(difference.topics.at("node_positions").only_in_a == 6);
  CHECK(difference.topics.at("node_positions").only_in_b == 0);
  CHECK(difference.topics.at("node_positions").compared == 14);
}

TEST_CASE("diff: a sample of real time is compared with the nearest in simulated time") {
  // Oracle: the pressures are the times: 0.3 ms apart or less, the middle sample of a hole in A is
  // nobody's. By order all behind it would be 4 ms off, and more.
  const ScratchFolder folder;
  const auto record_at = [&](SampleFile recording, std::span<const double> times_ms) {
    std::uint64_t sequence = 0;
    for (const double ms : times_ms) {
      NodePositions nodes = node_positions(++sequence, 1e-3, ms);
      nodes.header.sim_time_ns = ns_from_seconds(1e-3 * ms);
      recording.add(raw_sample(bus::kNodePositions, nodes, long(sequence), 1));
    }
    recording.close();
  };
  const std::vector<double> real{0.2, 4.1, 8.3, 16.1, 20.2, 24, 28.1};
  const std::vector<double> grid{0, 4, 8, 12, 16, 20, 24};
  record_at(SampleFile(folder / "a.mcap", {}), real);
  record_at(SampleFile::of_lockstep(folder / "b.mcap"), grid);
  for (const bool swapped : {false, true}) {
    const auto a = folder / (swapped ? "b.mcap" : "a.mcap");
    const auto b = folder / (swapped ? "a.mcap" : "b.mcap");
    const RecordingDifference difference = compare({.a = a, .b = b});
    const TopicDifference& topic = difference.topics.at("node_positions");
    CHECK(topic.compared == 6);
    CHECK((swapped ? topic.only_in_b : topic.only_in_a) == 1);  // 28.1
    CHECK((swapped ? topic.only_in_a : topic.only_in_b) == 1);  // 12
    CHECK(topic.fields.at("pressure_pa").largest == Approx(0.3));
    CHECK(difference.farthest_ns == 300'000);
    std::ostringstream said;
    print_difference(difference, said);
    CHECK_THAT(said.str(), Catch::StartsWith("recorded in real time: each sample beside the one "
                                             "nearest in simulated time, at most 0.0003 s away"));
  }
}

TEST_CASE("diff: simulated times that no codec takes are as far apart as can be told") {
  // Oracle: 2^63 - 1 ns, though they are 2^64 - 1 apart: as a difference of signed numbers 1 ns.
  using Limits = std::numeric_limits<std::int64_t>;
  const ScratchFolder folder;
  const auto record_at = [&](const std::filesystem::path& file, std::int64_t sim_time_ns) {
    SampleFile recording(file, {});
    NodePositions nodes = node_positions(1, 1e-3, 10);
    nodes.header.sim_time_ns = sim_time_ns;
    recording.add(raw_sample(bus::kNodePositions, nodes, 1, 1));
    recording.close();
    return file;
  };
  const auto a = record_at(folder / "a.mcap", Limits::max());
  const auto b = record_at(folder / "b.mcap", Limits::min());
  const RecordingDifference difference = compare({.a = a, .b = b});
  CHECK(difference.farthest_ns == Limits::max());
  CHECK(compare({.a = b, .b = a}).farthest_ns == Limits::max());
}

TEST_CASE("diff: of real time, what no two runs agree in is left out, and said") {
  // Oracle: one that was copied on another clock is the same; its status, which a session without a
  // clock has not, is nobody's. Pressures that differ still do.
  const ScratchFolder folder;
  const auto record_at = [&](SampleFile recording, std::int64_t clock_ns, double pressure) {
    NodePositions nodes = node_positions(std::uint64_t(1 + clock_ns), 1e-3, pressure);
    nodes.header.sim_time_ns = 4'000'000;
    nodes.header.source_time_ns = clock_ns + 4'000'000;
    recording.add(raw_sample(bus::kNodePositions, nodes, nodes.header.source_time_ns, 1));
    if (clock_ns > 0) recording.add(raw_sample(bus::kModuleStatus, ModuleStatus{}, clock_ns, 2));
    recording.close();
  };
  record_at(SampleFile(folder / "a.mcap", {}), 70, 10);
  record_at(SampleFile::of_lockstep(folder / "b.mcap"), 0, 10);
  record_at(SampleFile::of_lockstep(folder / "c.mcap"), 0, 11);
  const auto copied = compare({folder / "a.mcap", folder / "b.mcap"});
  CHECK(copied.equal());
  CHECK_FALSE(copied.topics.contains("module_status"));
  std::ostringstream said;
  print_difference(copied, said);
  CHECK_THAT(said.str(), Catch::Contains("not compared: clock module_status") &&
                             Catch::Contains(" sequence_number") &&
                             Catch::Contains(" source_time_ns"));
  const auto other = compare({folder / "a.mcap", folder / "c.mcap"});
  REQUIRE(other.first);
  CHECK(other.first->field == "pressure_pa");
}

TEST_CASE("diff: what is to be ignored makes no difference, and must exist") {
  // Oracle: the fields and topics that differ.
  const ScratchFolder folder;
  const auto a = record(folder / "a.mcap", {});
  const auto b = record(folder / "b.mcap", {.other_pressure_at = 6});
  CHECK(compare({.a = a, .b = b, .ignore = {"node_positions"}}).equal());
  CHECK(compare({.a = a, .b = b, .ignore = {"pressure_pa", "positions_m"}}).equal());
  CHECK_FALSE(compare({.a = a, .b = b, .ignore = {"pressure_pa"}}).equal());
  CHECK_THROWS_WITH(compare({.a = a, .b = b, .ignore = {"pressure"}}),
                    "--ignore pressure: neither a topic nor a field of a message");
  // Of entries of lists, too: of each list one.
  const std::set<std::string, std::less<>> of_lists{
      "contacts.gap_m",      "faces.gap_m",   "rows.gap_m",        "inputs.dropped",
      "organs.volume_ratio", "probes.limits", "echoes.received_ns"};
  CHECK_NOTHROW(compare({.a = a, .b = a, .ignore = of_lists}));
}

TEST_CASE("diff: the command's exit code says equal, different or bad input") {
  // Oracle: 0, 1 and 2.
  const ScratchFolder folder;
  const auto a = record(folder / "a.mcap", {});
  const auto b = record(folder / "b.mcap", {.other_pressure_at = 6});
  std::ostringstream out, err;
  CHECK(run_diff_command({.a = a, .b = a}, out, err) == 0);
  CHECK(out.str().ends_with("equal\n"));
  CHECK(run_diff_command({.a = a, .b = b}, out, err) == 1);
  CHECK(out.str().find("first difference at 0.024 s of the session: node_positions of 1, "
                       "pressure_pa: 10 and 10.5\n") != std::string::npos);
  CHECK(err.str().empty());
  CHECK(run_diff_command({.a = a, .b = folder / "none.mcap"}, out, err) == 2);
  CHECK(run_diff_command({.a = a, .b = b, .csv = "/nowhere/rows.csv"}, out, err) == 2);
  CHECK(err.str().find("none.mcap") != std::string::npos);
}

}  // namespace palpate::recording
