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
}
