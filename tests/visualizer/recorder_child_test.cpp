#include "visualizer/recorder_child.h"

#include <catch2/catch.hpp>
#include <fstream>
#include <string>

#include "modules/bus/dds_bus.h"
#include "tests/modules/runtime/own_bus.h"
#include "tests/scratch_folder.h"

using namespace palpate;
using visualizer::RecorderChild;

namespace {

const std::filesystem::path kRecorder = std::filesystem::path(PALPATE_BIN_DIR) / "palpate-recorder";

}  // namespace

TEST_CASE("recorder child: what is said while it lives is in the file when it has gone",
          "[visualizer][system]") {
  // Oracle: the recording, read back.
  const ScratchFolder folder;
  const auto options = palpate::testing::own_bus_options();
  const auto file = folder.path() / "take.mcap";
  bus::DdsBus bus(options);
  auto forces = bus.writer(bus::kHapticForce);
  {
    RecorderChild recorder(kRecorder, file, options);
    REQUIRE(palpate::testing::wait_until([&] { return forces.matched_readers() > 0; }));
    HapticForce force;
    REQUIRE(palpate::testing::wait_until([&] {
      forces.write(force);
      return std::filesystem::exists(file) && std::filesystem::file_size(file) > 20'000;
    }));
    CHECK(recorder.running());
    CHECK(recorder.file() == file);
    CHECK(recorder.end());
    CHECK_FALSE(recorder.running());
    CHECK(recorder.end());
  }
  std::ifstream stream(file, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  CHECK(bytes.find("haptic_force") != std::string::npos);
  CHECK(bytes.ends_with("\x89MCAP0\r\n"));  // whole, with its end
}

TEST_CASE("recorder child: one that cannot record is told from one that does",
          "[visualizer][fault]") {
  // Oracle: the program's exit.
  const ScratchFolder folder;
  RecorderChild recorder(kRecorder, folder.path() / "no" / "such" / "folder.mcap",
                         palpate::testing::own_bus_options());
  CHECK(palpate::testing::wait_until([&] { return !recorder.running(); }));
  CHECK_FALSE(recorder.end());
}

TEST_CASE("recorder child: one that fails at its end, or that does not end, has recorded nothing",
          "[visualizer][fault]") {
  // Oracle: a script's exit code; the stated patience of ten seconds.
  const ScratchFolder folder;
  const auto program = folder.path() / "recorder";
  const auto begun = folder.path() / "begun";
  const std::string at_term = GENERATE("exit 1", "true");
  std::ofstream(program) << "#!/bin/sh\ntrap '" << at_term << "' TERM\necho > " << begun.string()
                         << "\nwhile true; do sleep 0.01; done\n";
  std::filesystem::permissions(program, std::filesystem::perms::owner_all);
  RecorderChild recorder(program, folder.path() / "a.mcap", palpate::testing::own_bus_options());
  REQUIRE(palpate::testing::wait_until([&] { return std::filesystem::exists(begun); }));
  CHECK(recorder.running());
  CHECK_FALSE(recorder.end());
  CHECK_FALSE(recorder.running());
}
