#include "haptics/devices/trajectory_file.h"

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>

#include "modules/core/error.h"
#include "tests/scratch_folder.h"

using namespace palpate;
using namespace palpate::haptics;
using Catch::Matchers::Contains;
using Catch::Matchers::EndsWith;

namespace {

const std::string kHeader = "t,x,y,z,qx,qy,qz,qw\n";

struct Outcome {
  std::vector<TimedPose> samples;
  std::vector<std::string> warnings;
};

Outcome read(const std::string& text) {
  const ScratchFolder folder;
  const auto file = folder.write("recording.csv", text);
  Outcome outcome;
  outcome.samples = read_trajectory(file, outcome.warnings);
  return outcome;
}

std::string error_of(const std::string& text) {
  try {
    read(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

}  // namespace

TEST_CASE("trajectory file: columns, comments, blank lines and line ends are read as written") {
  // Oracle: the numbers in the text.
  const Outcome outcome = read(
      "# a comment\n\nt, x, y, z, qx, qy, qz, qw, fx, fy, fz\r\n"
      "0.5,1e-3,2,-3,0,0,0,1,9,9,9\r\n# in between\n 0.51 , 0.1, 0.2,0.3,0,0,1.0005,0,9,9,9");
  CHECK(outcome.warnings.empty());
  REQUIRE(outcome.samples.size() == 2);
  CHECK(outcome.samples[0].time == 0.5);
  CHECK(outcome.samples[0].pose.position == Vec3(1e-3, 2, -3));
  CHECK(outcome.samples[0].pose.rotation.w() == 1);
  CHECK(outcome.samples[1].pose.position == Vec3(0.1, 0.2, 0.3));
  CHECK(outcome.samples[1].pose.rotation.z() == 1);  // normalised
}

TEST_CASE("trajectory file: one that cannot be used is refused with file and line") {
  // Oracle: the stated rules and their messages.
  std::vector<std::string> warnings;
  CHECK_THROWS_WITH(read_trajectory("no/such.csv", warnings),
                    "no/such.csv: recording cannot be opened");
  CHECK_THROWS_AS(read_trajectory("no/such.csv", warnings), InputError);
  CHECK_THROWS_WITH(read_trajectory(std::filesystem::temp_directory_path(), warnings),
                    EndsWith("recording cannot be opened"));
  CHECK_THAT(error_of(""), EndsWith("recording.csv:0: no header, must be "
                                    "'t,x,y,z,qx,qy,qz,qw', with or without ',fx,fy,fz'"));
  CHECK_THAT(error_of("# only\n# comments\n"), Contains("recording.csv:2: no header"));
  CHECK_THAT(error_of("#\nt,x,y,z,qw,qx,qy,qz\n"),
             EndsWith("recording.csv:2: header is 't,x,y,z,qw,qx,qy,qz', must be "
                      "'t,x,y,z,qx,qy,qz,qw', with or without ',fx,fy,fz'"));
  CHECK_THAT(error_of("0,0,0,0,0,0,0,1\n0.1,0,0,0,0,0,0,1\n"), Contains("recording.csv:1: header"));
  CHECK_THAT(error_of(kHeader + "0,0,0,0,0,0,0,1\n"),
             EndsWith("recording.csv:2: only 1 usable rows, at least 2 are needed"));
  CHECK_THAT(error_of(kHeader + "0,0,0,0,0,0,0,1\n0.1,0,0,0,0,0,0\n"),
             Contains("recording.csv:3: only 1 usable rows") && Contains("has 7 columns"));
}

TEST_CASE("trajectory file: a bad row is skipped and reported with line and reason") {
  // Oracle: the stated rules and their messages. The bad row is always line 3.
  const auto [row, reason] = GENERATE(table<std::string, std::string>({
      {"0.01,0,0,0,0,0,0", "has 7 columns, the header 8"},
      {"0.01,0,0,0,0,0,0,1,5", "has 9 columns, the header 8"},
      {"0.01,0,0,0,0,0,0,", "column 8 is '', not a finite number"},
      {"0.01,left,0,0,0,0,0,1", "column 2 is 'left', not a finite number"},
      {"0.01,0,0.5m,0,0,0,0,1", "column 3 is '0.5m', not a finite number"},
      {"0.01,0,0,nan,0,0,0,1", "column 4 is 'nan', not a finite number"},
      {"inf,0,0,0,0,0,0,1", "column 1 is 'inf', not a finite number"},
      {"0.01,0,1e999,0,0,0,0,1", "column 3 is '1e999', not a finite number"},
      {"0,0,0,0,0,0,0,1", "t = 0 s is not at least 1e-6 s after the previous 0 s"},
      {"-1,0,0,0,0,0,0,1", "t = -1 s is not at least 1e-6 s after the previous 0 s"},
      {"0.01,0,0,2000,0,0,0,1", "position is beyond 1000 m (metres expected)"},
      {"0.01,0,0,0,0,0,0,1.01", "quaternion has length 1.01, must be 1 within 0.001"},
      {"0.01,0,0,0,0,0,0,0", "quaternion has length 0, must be 1 within 0.001"},
  }));
  const Outcome outcome =
      read(kHeader + "0,0,0,0,0,0,0,1\n" + row + "\n0.02,1,0,0,0,0,0,1\n0.04,1,0,0,0,0,0,1\n");
  CHECK(outcome.samples.size() == 3);
  REQUIRE(outcome.warnings.size() == 1);
  CHECK_THAT(outcome.warnings[0], EndsWith("recording.csv:3: row skipped: " + reason));
}

TEST_CASE("trajectory file: a gap is reported where it ends, with its length") {
  // Oracle: the stated rule, more than 5 times the median step or more than 0.1 s.
  std::string text = kHeader;
  for (const char* t : {"0", "0.01", "0.02", "0.0699", "0.08", "0.14", "0.15"}) {
    text += std::string(t) + ",0,0,0,0,0,0,1\n";
  }
  const Outcome by_median = read(text);
  REQUIRE(by_median.warnings.size() == 1);
  CHECK_THAT(by_median.warnings[0], EndsWith("recording.csv:7: gap of 0.06 s before t = 0.14 s, "
                                             "bridged by interpolation"));

  text = kHeader;
  for (const char* t : {"0", "0.05", "0.1", "0.15", "0.26"}) {
    text += std::string(t) + ",0,0,0,0,0,0,1\n";
  }
  const Outcome by_length = read(text);
  REQUIRE(by_length.warnings.size() == 1);
  CHECK_THAT(by_length.warnings[0], Contains("recording.csv:6: gap of 0.11 s before t = 0.26 s"));
}

TEST_CASE("trajectory file: many bad rows or gaps are counted, not listed without end") {
  // Oracle: counting. 30 bad rows among 31 good ones, each 0.2 s after the one before: 30 gaps.
  std::string text = kHeader;
  for (int i = 0; i <= 30; ++i) {
    text += std::to_string(0.2 * i) + ",0,0,0,0,0,0,1\n";
    if (i < 30) text += "broken\n";
  }
  const Outcome outcome = read(text);
  CHECK(outcome.samples.size() == 31);
  REQUIRE(outcome.warnings.size() == 42);
  CHECK_THAT(outcome.warnings[20], EndsWith("in all 30 rows skipped"));
  CHECK_THAT(outcome.warnings[41], Contains("in all 30 gaps, the longest, here, of 0.2 s"));
}
