// Recordings as a reader that is not ours sees them: npm's @mcap/core with the omgidl parser.
#include <catch2/catch.hpp>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <memory>

#include "tests/modules/recording/payloads.h"
#include "tests/modules/recording/recording_files.h"

namespace palpate::recording {
namespace {

std::string output_of(const std::string& command) {
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  std::string output;
  char buffer[4096];
  while (pipe && std::fgets(buffer, sizeof buffer, pipe.get())) output += buffer;
  return output;
}

// Folder node_modules with the packages named in docs/recording.md; empty if there is none.
std::string node_modules() {
  const char* folder = std::getenv("PALPATE_NODE_MODULES");
  if (folder == nullptr || !std::filesystem::exists(std::filesystem::path(folder) / "@mcap/core") ||
      output_of("node --version 2>/dev/null").empty()) {
    return {};
  }
  return folder;
}

}  // namespace

TEST_CASE("independent reader: decodes recordings from their own schemas") {
  // Oracle: @mcap/core and @foxglove/omgidl-serialization, which share no code with ours.
  const std::string modules = node_modules();
  if (modules.empty()) {
    std::cout << "SKIPPED: node or PALPATE_NODE_MODULES with @mcap/core is missing\n";
    return;
  }
  const ScratchFolder folder;
  SampleFile file(folder / "a.mcap", {.domain = 0, .session = "judged"});
  file.add(raw_sample(bus::kNodePositions, node_positions(41, 0.5, -3), 1'000));
  file.add(raw_sample(bus::kProbeState, probe_state(7, 9, 2, {0.25, -1, 8}), 2'000));
  ModuleStatus status;
  status.header = {1, 0, 1};
  status.module = "haptics";
  status.state = ModuleState::kRunning;
  status.inputs = {{"contact_model", 0.125, 10, 1, 0}};
  file.add(raw_sample(bus::kModuleStatus, status, 3'000));
  file.close();

  const std::string output =
      output_of("node " PALPATE_SOURCE_DIR "/tests/recording/read_mcap.mjs " +
                (folder / "a.mcap").string() + " " + modules + " 2>&1");
  using Catch::Contains;
  CHECK_THAT(output, Contains("metadata palpate session judged\n"));
  CHECK_THAT(output, Contains("message node_positions 41 1000 {\"sequence_number\":41,"));
  CHECK_THAT(output, Contains("\"volume_m3\":0.5,"));
  CHECK_THAT(output, Contains("\"pressure_pa\":-3,"));
  CHECK_THAT(output, Contains("message probe_state 7 2000 "));
  CHECK_THAT(output, Contains("\"probe\":2,\"position_m\":[0.25,-1,8],"));
  CHECK_THAT(output, Contains("\"module_name\":\"haptics\",\"state\":2,"));
  CHECK_THAT(output, Contains("{\"topic\":\"contact_model\",\"age_s\":0.125,\"received\":10,"));
  CHECK_THAT(output, Contains("statistics 3\n"));
  CHECK_THAT(output, Catch::EndsWith("whole\n"));
}

}  // namespace palpate::recording
