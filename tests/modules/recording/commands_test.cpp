#include "modules/recording/commands.h"

#include <catch2/catch.hpp>
#include <set>
#include <sstream>

#include "modules/core/error.h"
#include "modules/recording/recorder.h"
#include "modules/recording/sample_reader.h"
#include "tests/modules/bus/loopback.h"
#include "tests/modules/recording/payloads.h"
#include "tests/modules/recording/recording_files.h"

namespace palpate::recording {
namespace {

void write_recording(const std::filesystem::path& file, bool close) {
  SampleFile writer(file, {});
  writer.add(raw_sample(bus::kNodePositions, node_positions(1, 1e-3, 5), 1'000));
  writer.add(raw_sample(bus::kNodePositions, node_positions(2, 1e-3, 5), 2'000));
  writer.end_chunk();
  writer.flush();
  if (close) writer.close();
}

}  // namespace

TEST_CASE("commands: inspect prints the table and warns of a torn file") {
  // Oracle: exit codes of core/error.h and the texts by hand.
  const ScratchFolder folder;
  write_recording(folder / "whole.mcap", true);
  write_recording(folder / "torn.mcap", false);
  std::ostringstream out, err;
  CHECK(run_inspect_command({folder / "whole.mcap", {}}, out, err) == kExitDone);
  CHECK_THAT(out.str(), Catch::Contains("node_positions"));
  CHECK(err.str().empty());
  CHECK(run_inspect_command({folder / "torn.mcap", folder / "csv"}, out, err) == kExitDone);
  CHECK_THAT(err.str(), Catch::StartsWith("warning: "));
  CHECK(std::filesystem::exists(folder / "csv/node_positions_0.csv"));
}

TEST_CASE("commands: inspect repairs a torn file into another") {
  // Oracle: the repaired file equals the whole one, by diff, and is not torn.
  const ScratchFolder folder;
  write_recording(folder / "whole.mcap", true);
  write_recording(folder / "torn.mcap", false);
  std::ostringstream out, err, nothing;
  CHECK(run_inspect_command({folder / "torn.mcap", {}, false, folder / "again.mcap"}, out, err) ==
        kExitDone);
  CHECK_THAT(err.str(),
             Catch::EndsWith("again.mcap: 2 samples; left out: 0 damaged pieces and a torn end\n"));
  CHECK(run_diff_command({.a = folder / "whole.mcap", .b = folder / "again.mcap"}, out, nothing) ==
        kExitDone);
  CHECK(nothing.str().empty());
  CHECK(run_inspect_command({folder / "torn.mcap", {}, false, folder / "again.mcap"}, out, err) ==
        kExitBadInput);
}

TEST_CASE("commands: inspect repairs all parts into one, and names those it cannot take") {
  // Oracle: the times given to the samples, in the order of the parts; the texts by hand.
  const ScratchFolder folder;
  const auto file = folder / "a.mcap", again = folder / "again.mcap";
  for (const int part : {1, 2, 4}) {
    SampleFile writer(part_of(file, part), {});
    for (const int writer_id : {1, 2}) {
      writer.add(raw_sample(bus::kNodePositions, node_positions(1, 1e-3, 5), 10 * part, writer_id));
    }
    writer.end_chunk();
    writer.add_metadata({kCostMetadata, {{"wall_s", "1"}}});
    writer.flush();
    if (part != 1) writer.close();
  }
  write_bytes(part_of(file, 3), {'n', 'o'});
  std::ostringstream out, err;
  CHECK(run_inspect_command({file, {}, false, again}, out, err) == kExitDone);
  CHECK_THAT(
      err.str(),
      Catch::StartsWith(again.string() + ": 6 samples of 3 parts; left out: 0 damaged pieces and "
                                         "a torn end\nwarning: ") &&
          Catch::Contains("a.part3.mcap") && Catch::EndsWith("; this part is left out\n"));
  SampleReader reader(again);
  std::vector<std::int64_t> times;
  std::set<int> channels;
  while (const auto sample = reader.next()) {
    times.push_back(sample->received_time_ns);
    channels.insert(sample->channel);
  }
  CHECK(times == std::vector<std::int64_t>{10, 10, 20, 20, 40, 40});
  CHECK(channels.size() == 6);  // each part has its own writers
  CHECK_FALSE(reader.torn());
  McapReader records(again);
  int costs = 0;
  while (const auto record = records.next()) {
    const auto* metadata = std::get_if<McapMetadata>(&*record);
    costs += metadata != nullptr && metadata->name == kCostMetadata ? 1 : 0;
  }
  CHECK(costs == 1);
}

TEST_CASE("commands: diff warns of a torn file, whichever of the two it is") {
  // Oracle: the same samples in both; the torn one's name.
  const ScratchFolder folder;
  write_recording(folder / "whole.mcap", true);
  write_recording(folder / "torn.mcap", false);
  for (const auto& [a, b] : {std::pair{"whole.mcap", "torn.mcap"}, {"torn.mcap", "whole.mcap"}}) {
    std::ostringstream out, err;
    CHECK(run_diff_command({.a = folder / a, .b = folder / b}, out, err) == kExitDone);
    CHECK_THAT(out.str(), Catch::EndsWith("equal\n"));
    CHECK_THAT(err.str(), Catch::StartsWith("warning: ") && Catch::Contains("torn.mcap"));
  }
  std::ostringstream out, err;
  CHECK(run_diff_command({.a = folder / "whole.mcap", .b = folder / "whole.mcap"}, out, err) == 0);
  CHECK(err.str() == "");
}

TEST_CASE(
    "commands: a bad recording is bad input, and so is a file where the CSV folder should be") {
  // Oracle: exit codes of core/error.h.
  const ScratchFolder folder;
  std::ostringstream out, err;
  CHECK(run_inspect_command({folder / "none.mcap", {}}, out, err) == kExitBadInput);
  CHECK_THAT(err.str(), Catch::EndsWith("none.mcap: no such file\n"));
  write_bytes(folder / "text.mcap", {'n', 'o'});
  CHECK(run_inspect_command({folder / "text.mcap", {}}, out, err) == kExitBadInput);
  CHECK(run_replay_command({folder / "text.mcap", bus::testing::own_options()}, kNeverStop, out,
                           err) == kExitBadInput);
  write_recording(folder / "a.mcap", true);
  CHECK(run_inspect_command({folder / "a.mcap", folder / "text.mcap"}, out, err) == kExitBadInput);
  CHECK_THAT(
      err.str(),
      Catch::EndsWith("text.mcap': must be a folder that can be written (Not a directory)\n"));
  CHECK(out.str().empty());
}

TEST_CASE("commands: replay waits for a reader, plays, and says what it played") {
  // Oracle: the bus's own reader, of a topic that reaches late joiners too.
  const ScratchFolder folder;
  {
    SampleFile writer(folder / "torn.mcap", {});
    ModuleStatus status;
    status.header = {3, 0, 1};
    status.module = "haptics";
    status.cycles = 77;
    writer.add(raw_sample(bus::kModuleStatus, status, 1'000));
    writer.end_chunk();
    writer.flush();
  }
  const auto options = bus::testing::own_options();
  bus::DdsBus bus(options);
  auto statuses = bus.reader(bus::kModuleStatus);
  const auto nodes = bus.reader(bus::kNodePositions);  // what replay waits for
  std::ostringstream out, err;
  CHECK(run_replay_command({folder / "torn.mcap", options}, kNeverStop, out, err) == kExitDone);
  ModuleStatus status;
  REQUIRE(bus::testing::take_soon(statuses, status));
  CHECK(status.cycles == 77);
  CHECK_THAT(out.str(), Catch::StartsWith("replayed 1 samples, "));
  CHECK_THAT(err.str(),
             Catch::StartsWith("warning: ") && Catch::Contains("not closed by its writer"));
}

TEST_CASE("commands: replay plays although nobody listens, and says so") {
  // Oracle: the text by hand.
  const ScratchFolder folder;
  write_recording(folder / "a.mcap", true);
  const auto options = bus::testing::own_options();
  std::ostringstream out, err;
  CHECK(run_replay_command({folder / "a.mcap", options, 0.05}, kNeverStop, out, err) == kExitDone);
  CHECK_THAT(err.str(), Catch::Contains("nobody listens in session '" + options.session + "'"));
  CHECK_THAT(out.str(), Catch::StartsWith("replayed 2 samples"));
}

TEST_CASE("commands: a stopped replay is done") {
  // Oracle: exit codes of core/error.h.
  const ScratchFolder folder;
  write_recording(folder / "a.mcap", true);
  std::ostringstream out, err;
  CHECK(run_replay_command(
            {folder / "a.mcap", bus::testing::own_options()}, [] { return true; }, out, err) ==
        kExitDone);
  CHECK_THAT(out.str(), Catch::StartsWith("stopped after 0 samples"));
}

}  // namespace palpate::recording
