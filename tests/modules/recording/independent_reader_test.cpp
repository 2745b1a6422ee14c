// Recordings as a reader that is not ours sees them: npm's @mcap/core with the omgidl parser.
#include <catch2/catch.hpp>
#include <iostream>
#include <sstream>

#include "tests/modules/recording/node_judge.h"
#include "tests/modules/recording/payloads.h"
#include "tests/modules/recording/recording_files.h"

namespace palpate::recording {
namespace {

std::string judged(const std::filesystem::path& file, const std::string& modules) {
  return testing::judged_by("read_mcap.mjs", file, modules);
}

constexpr Clocks kClocks{0, 1'700'000'000'000'000'000};

}  // namespace

TEST_CASE("independent reader: decodes recordings through their indexes, by their own schemas") {
  // Oracle: @mcap/core and @foxglove/omgidl-serialization, which share no code with ours.
  const std::string modules = testing::node_modules();
  if (modules.empty()) {
    std::cout << testing::kNoNode;
    return;
  }
  const ScratchFolder folder;
  SampleFile file(folder / "a.mcap", {.domain = 0, .session = "judged"}, kClocks);
  file.add(raw_sample(bus::kNodePositions, node_positions(41, 0.5, -3), 1'000));
  file.add(raw_sample(bus::kProbeState, probe_state(7, 9, 2, {0.25, -1, 8}), 2'000));
  ModuleStatus status;
  status.header = {1, 0, 1};
  status.module = "haptics";
  status.state = ModuleState::kRunning;
  status.inputs = {{"contact_model", 0.125, 0, 10, 1, 0}};
  file.add(raw_sample(bus::kModuleStatus, status, 3'000));
  file.close();

  const std::string output = judged(folder / "a.mcap", modules);
  using Catch::Contains;
  CHECK_THAT(output, Contains("metadata palpate session judged\n"));
  CHECK_THAT(output,
             Contains("message node_positions 41 1700000000000001000 {\"sequence_number\":41,"));
  CHECK_THAT(output, Contains("\"volume_m3\":0.5,"));
  CHECK_THAT(output, Contains("\"pressure_pa\":-3,"));
  CHECK_THAT(output, Contains("message probe_state 7 1700000000000002000 "));
  CHECK_THAT(output, Contains("\"probe\":2,\"position_m\":[0.25,-1,8],"));
  CHECK_THAT(output, Contains("\"module_name\":\"haptics\",\"state\":2,"));
  CHECK_THAT(
      output,
      Contains("{\"topic\":\"contact_model\",\"age_s\":0.125,\"age_error_s\":0,\"received\":10,"));
  CHECK_THAT(output, Contains("statistics 3\n"));
  CHECK_THAT(output, Catch::EndsWith("whole\n"));
}

TEST_CASE("independent reader: finds every sample of many chunks, in order of time") {
  // Oracle: the indexed reader of @mcap/core; the numbers of the samples that were recorded.
  const std::string modules = testing::node_modules();
  if (modules.empty()) {
    std::cout << testing::kNoNode;
    return;
  }
  const ScratchFolder folder;
  constexpr int kSamples = 2000;
  SampleFile file(folder / "a.mcap", {.domain = 0, .session = "judged"}, kClocks);
  for (int i = 1; i <= kSamples; ++i) {
    const auto number = static_cast<std::uint64_t>(i);
    const std::int64_t time_ns = std::int64_t{4'000'000} * i;
    file.add(raw_sample(bus::kNodePositions, node_positions(number, 0.5, i), time_ns));
  }
  file.close();
  std::istringstream lines(judged(folder / "a.mcap", modules));
  std::string line;
  REQUIRE(std::getline(lines, line));
  CHECK_THAT(line, Catch::StartsWith("chunks 1"));  // 8 s in pieces of half a second: 16
  int found = 0;
  std::string last;
  for (; std::getline(lines, line); last = line) {
    if (!line.starts_with("message ")) continue;
    ++found;
    REQUIRE_THAT(line, Catch::StartsWith("message node_positions " + std::to_string(found) + " "));
  }
  CHECK(found == kSamples);
  CHECK(last == "whole");
}

}  // namespace palpate::recording
