// scripts/plots/plot_recording.py on the files that inspection writes.
#include <sys/wait.h>

#include <catch2/catch.hpp>
#include <cstdlib>
#include <iostream>

#include "modules/recording/inspect.h"
#include "tests/modules/recording/payloads.h"
#include "tests/modules/recording/recording_files.h"

namespace palpate::recording {
namespace {

// The interpreter that has matplotlib: first in the path, or Debian's. Empty if none has.
std::string python() {
  for (const std::string program : {"python3", "/usr/bin/python3"}) {
    if (std::system((program + " -c 'import matplotlib' 2>/dev/null").c_str()) == 0) return program;
  }
  std::cout << "SKIPPED: python3 with matplotlib is missing\n";
  return {};
}

int run_script(const std::string& program, const std::string& arguments,
               const std::filesystem::path& output) {
  const std::string command = program + " " PALPATE_SOURCE_DIR "/scripts/plots/plot_recording.py " +
                              arguments + " > " + output.string() + " 2>&1";
  return WEXITSTATUS(std::system(command.c_str()));
}

// Width and height in a PNG's first chunk, big-endian; zeros if it is none.
std::pair<int, int> png_size(const std::filesystem::path& file) {
  const auto bytes = bytes_of(file);
  if (bytes.size() < 24 || bytes[1] != 'P' || bytes[2] != 'N' || bytes[3] != 'G') return {0, 0};
  const auto number = [&](std::size_t at) { return bytes[at + 2] * 256 + bytes[at + 3]; };
  return {number(16), number(20)};
}

}  // namespace

TEST_CASE("plot recording: draws the curves of an inspected recording") {
  // Oracle: the file is a PNG of the size asked for (9 × 12 inches at 110 dpi, cut to content).
  const std::string program = python();
  if (program.empty()) return;
  const ScratchFolder folder;
  SampleFile file(folder / "a.mcap", {});
  for (std::uint64_t i = 1; i <= 50; ++i) {
    file.add(raw_sample(bus::kNodePositions, node_positions(i, 1e-3, 10), 4'000'000 * long(i)));
  }
  file.close();
  summarize(folder / "a.mcap", folder / "csv");
  const auto picture = folder / "plots.png";
  CHECK(run_script(program, "plots " + (folder / "csv").string() + " " + picture.string(),
                   folder / "log") == 0);
  CHECK(text_in(folder / "log").empty());
  CHECK(png_size(picture).first > 800);
  CHECK(png_size(picture).second > 800);

  const auto strip = folder / "strip.png";
  std::filesystem::create_directory(folder / "frames");
  for (const char* frame : {"frame_000000.000.png", "frame_000001.500.png"}) {
    std::filesystem::copy_file(picture, folder / "frames" / frame);
  }
  CHECK(run_script(program,
                   "strip " + (folder / "frames").string() + " " + strip.string() + " --count 2",
                   folder / "log") == 0);
  CHECK(png_size(strip).first > 700);  // two panels of 3 inches at 150 dpi
}

TEST_CASE("plot recording: folders without content are bad input, told in one line") {
  // Oracle: exit code 2 and the texts by hand.
  const std::string program = python();
  if (program.empty()) return;
  const ScratchFolder folder;
  std::filesystem::create_directory(folder / "empty");
  const std::string empty = (folder / "empty").string();
  CHECK(run_script(program, "plots " + empty + " " + empty + "/a.png", folder / "log") == 2);
  CHECK(text_in(folder / "log") ==
        "error: " + empty + ": holds no samples from after the start of a session\n");
  CHECK(run_script(program, "strip " + empty + " " + empty + "/a.png", folder / "log") == 2);
  CHECK(text_in(folder / "log") == "error: " + empty + ": holds no frame_<seconds>.png\n");
  CHECK(run_script(program, "plots " + empty + "/no a.png", folder / "log") == 2);
  CHECK(text_in(folder / "log") == "error: " + empty + "/no: no such folder\n");
}

}  // namespace palpate::recording
