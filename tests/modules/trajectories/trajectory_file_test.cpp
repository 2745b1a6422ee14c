#include "modules/trajectories/trajectory_file.h"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>

#include "modules/core/error.h"
#include "modules/trajectories/pose_collector.h"
#include "tests/scratch_folder.h"

using namespace palpate;
using namespace palpate::trajectories;
using Catch::Matchers::Contains;
using Catch::Matchers::EndsWith;

namespace {

const std::string kHeader = "t,x,y,z,qx,qy,qz,qw\n";

struct Outcome {
  std::vector<TimedPose> samples;
  std::vector<std::string> warnings;
};

Outcome read(const std::string& text, scene::TrajectoryDevice config = {}) {
  const ScratchFolder folder;
  config.file = folder.write("recording.csv", text);
  Outcome outcome;
  outcome.samples = read_trajectory(config, outcome.warnings);
  return outcome;
}

std::string error_of(const std::string& text, const scene::TrajectoryDevice& config = {}) {
  try {
    read(text, config);
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
  REQUIRE(outcome.warnings.size() == 1);
  CHECK_THAT(outcome.warnings[0], Contains("faster than"));  // half a turn in 10 ms
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
  CHECK_THROWS_WITH(read_trajectory({.file = "no/such.csv"}, warnings),
                    "no/such.csv: no such file");
  CHECK_THROWS_AS(read_trajectory({.file = "no/such.csv"}, warnings), InputError);
  CHECK_THROWS_WITH(read_trajectory({.file = std::filesystem::temp_directory_path()}, warnings),
                    EndsWith(": is a folder, not a file"));
  CHECK_THAT(error_of(""), EndsWith("recording.csv:0: holds no line that is not a comment"));
  CHECK_THAT(error_of("# only\n# comments\n"), Contains("recording.csv:2: holds no line"));
  CHECK_THAT(error_of("#\ntime,x,y,z,qw,qx,qy,qz\n"),
             Contains("recording.csv:2: header is 'time,x,y,z,qw,qx,qy,qz', must hold the columns "
                      "t,x,y,z,qx,qy,qz,qw; name others by key columns"));
  CHECK_THAT(error_of("0,0,0,0,0,0,0,1\n0.1,0,0,0,0,0,0,1\n"), Contains("recording.csv:1: header"));
  CHECK_THAT(error_of(kHeader + "0,0,0,0,0,0,0,1\n"),
             EndsWith("recording.csv:2: only 1 usable poses, at least 2 are needed"));
  CHECK_THAT(error_of(kHeader + "0,0,0,0,0,0,0,1\n0.1,0,0,0,0,0,0\n"),
             Contains("recording.csv:3: only 1 usable poses") && Contains("has 7 columns"));
}

TEST_CASE("trajectory file: a bad row is skipped and reported with line and reason") {
  // Oracle: the stated rules and their messages. The bad row is always line 3.
  const auto [row, reason] = GENERATE(table<std::string, std::string>({
      {"0.01,0,0,0,0,0,0", "has 7 columns, the first line 8"},
      {"0.01,0,0,0,0,0,0,1,5",
       "has 9 columns, the first line 8 (decimal commas are not read: write points)"},
      {"0.01,0,0,0,0,0,0,", "column 8 is '', not a finite number"},
      {"0.01,left,0,0,0,0,0,1", "column 2 is 'left', not a finite number"},
      {"0.01,0,0.5m,0,0,0,0,1", "column 3 is '0.5m', not a finite number"},
      {"0.01,0,0,nan,0,0,0,1", "column 4 is 'nan', not a finite number"},
      {"inf,0,0,0,0,0,0,1", "column 1 is 'inf', not a finite number"},
      {"0.01,0,1e999,0,0,0,0,1", "column 3 is '1e999', not a finite number"},
      {"0,0,0,0,0,0,0,1", "t = 0 s is not at least 1e-6 s after the previous 0 s"},
      {"-1,0,0,0,0,0,0,1", "t = -1 s is not at least 1e-6 s after the previous 0 s"},
      {"0.01,0,0,2000,0,0,0,1", "position is beyond 1000 m (see key length_unit)"},
      {"0.01,0,0,0,0,0,0,1.01", "quaternion has length 1.01, must be 1 within 0.001"},
      {"0.01,0,0,0,0,0,0,0", "quaternion has length 0, must be 1 within 0.001"},
  }));
  const Outcome outcome =
      read(kHeader + "0,1,0,0,0,0,0,1\n" + row + "\n0.02,1,0,0,0,0,0,1\n0.04,1,0,0,0,0,0,1\n");
  CHECK(outcome.samples.size() == 3);
  REQUIRE(outcome.warnings.size() == 1);
  CHECK_THAT(outcome.warnings[0], EndsWith("recording.csv:3: left out: " + reason));
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

TEST_CASE("trajectory file: times in another unit are one hint, not a gap each") {
  // Oracle: by hand. 50 poses a second, stamped in each unit and read as seconds.
  for (const auto& [step, hint] : std::vector<std::pair<std::string, std::string>>{
           {"20", "milliseconds? Then say time_unit: ms"},
           {"20000", "microseconds? Then say time_unit: us"},
           {"20000000", "nanoseconds? Then say time_unit: ns"}}) {
    std::string text = "t,x,y,z,qx,qy,qz,qw\n";
    for (int i = 0; i < 40; ++i) {
      text += std::to_string(i * std::stoll(step)) + ",0,0,0.001,0,0,0,1\n";
    }
    const ScratchFolder folder;
    std::vector<std::string> warnings;
    read_trajectory({.file = folder.write("long.csv", text)}, warnings);
    REQUIRE(warnings.size() == 1);
    CHECK_THAT(warnings[0], Contains("long.csv: 40 poses") && EndsWith("times in " + hint));
    CHECK(is_of_steps(warnings[0]));
  }
  CHECK_FALSE(is_of_steps("a.csv:7: left out: position is beyond 1000 m"));
}

TEST_CASE("trajectory file: positions alone need four columns, which a refusal of a header says") {
  // Oracle: the header's own names, with which it is read.
  const ScratchFolder folder;
  const auto file = folder.write("xyz.csv", "time,x,y,z\n0,0,0,0\n0.01,0,0,0\n");
  std::vector<std::string> warnings;
  CHECK_THROWS_WITH(read_trajectory({.file = file}, warnings),
                    EndsWith("four are enough, as columns: [time, x, y, z]"));
  CHECK(read_trajectory({.file = file, .columns = {"time", "x", "y", "z"}}, warnings).size() == 2);
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
  CHECK_THAT(outcome.warnings[20], EndsWith("in all 30 left out, of these 0 with a repeated time"));
  CHECK_THAT(outcome.warnings[41], Contains("in all 30 gaps, the longest, here, of 0.2 s"));
}

TEST_CASE("trajectory file: columns by name or number, separators, units and quaternion order") {
  // Oracle: one motion, written down in ways that mean the same.
  const std::string plain =
      "t,x,y,z,qx,qy,qz,qw\n0,1,2,3,0.6,0,0,0.8\n0.01,1.001,2,3,0.6,0,0,0.8\n"
      "0.02,1.002,2,3,0.6,0,0,0.8\n";
  const Outcome expected = read(plain);
  CHECK(expected.warnings.empty());
  using Device = scene::TrajectoryDevice;
  Device named;
  named.columns = {"stamp", "px", "py", "pz", "q0", "q1", "q2", "q3"};
  named.quaternion = Device::QuaternionOrder::kWxyz;
  Device numbered = named;
  numbered.columns = {"2", "3", "4", "5", "6", "7", "8", "9"};
  Device milli;
  milli.time_unit = Device::TimeUnit::kMilliseconds;
  milli.length_unit = "mm";
  Device first_w;
  first_w.quaternion = Device::QuaternionOrder::kWxyz;
  const std::string rows =
      "a;0;1;2;3;0.8;0.6;0;0\na;0.01;1.001;2;3;0.8;0.6;0;0\na;0.02;1.002;2;3;0.8;0.6;0;0\n";
  const auto with = [](std::string text, char separator) {
    std::replace(text.begin(), text.end(), ',', separator);
    return text;
  };
  struct Way {
    std::string what, text;
    Device config;
  };
  const std::vector<Way> ways{
      {"byte-order mark", "\xEF\xBB\xBF" + plain, {}},
      {"semicolons", with(plain, ';'), {}},
      {"tabs", with(plain, '\t'), {}},
      {"blanks", with(plain, ' '), {}},
      {"many blanks",
       "  t  x y z qx qy qz qw \n 0 1  2 3 0.6 0 0 0.8\n0.01 1.001 2 3 .6 0 0 .8\n"
       "2e-2   1.002 2 3 0.6 0 0 0.8\n",
       {}},
      {"quoted names",
       "\"t\",\"x\",\"y\",\"z\",\"qx\",\"qy\",\"qz\",\"qw\"" + plain.substr(19),
       {}},
      {"another order",
       "qw,t,extra,x,y,z,qx,qy,qz\n0.8,0,left,1,2,3,0.6,0,0\n0.8,0.01,,1.001,2,3,0.6,0,0\n"
       "0.8,0.02,?,1.002,2,3,0.6,0,0\n",
       {}},
      {"names", "who;stamp;px;py;pz;q0;q1;q2;q3\n" + rows, named},
      {"numbers, no header", rows, numbered},
      {"numbers, a header", "who;stamp;px;py;pz;q0;q1;q2;q3\n" + rows, numbered},
      {"units",
       "t,x,y,z,qx,qy,qz,qw\n0,1e3,2e3,3000,.6,0,0,.8\n10,1001,2000,3000,.6,0,0,.8\n"
       "20,1002,2000,3000,.6,0,0,.8\n",
       milli},
      {"w first by name",
       "t,x,y,z,qw,qx,qy,qz\n0,1,2,3,.8,.6,0,0\n0.01,1.001,2,3,.8,.6,0,0\n"
       "0.02,1.002,2,3,.8,.6,0,0\n",
       first_w}};
  for (const Way& way : ways) {
    INFO(way.what);
    const Outcome outcome = read(way.text, way.config);
    CHECK(outcome.warnings == expected.warnings);
    REQUIRE(outcome.samples.size() == expected.samples.size());
    for (std::size_t i = 0; i < outcome.samples.size(); ++i) {
      const auto &a = outcome.samples[i], &b = expected.samples[i];
      CHECK(a.time == Approx(b.time).margin(1e-17));  // rounding of the unit
      CHECK((a.pose.position - b.pose.position).norm() < 1e-15);
      CHECK(a.pose.rotation.coeffs() == b.pose.rotation.coeffs());
    }
  }
}

TEST_CASE("trajectory file: without a rotation, the probe keeps the recording's axes") {
  // Oracle: the identity.
  scene::TrajectoryDevice points;
  points.columns = {"t", "x", "y", "z"};
  const Outcome outcome = read("t,x,y,z\n0,1,2,3\n0.01,1,2,3\n", points);
  REQUIRE(outcome.samples.size() == 2);
  CHECK(outcome.samples[1].pose.rotation.coeffs() == Quat::Identity().coeffs());
  CHECK(outcome.samples[1].pose.position == Vec3(1, 2, 3));
}

TEST_CASE("trajectory file: stamps since 1970 keep their nanoseconds") {
  // Oracle: the digits in the text. A double alone would keep 256 ns of them.
  scene::TrajectoryDevice config;
  config.time_unit = scene::TrajectoryDevice::TimeUnit::kNanoseconds;
  const Outcome whole = read(kHeader +
                                 "1700000000123456789,0,0,0,0,0,0,1\n"
                                 "1700000000124456790,0,0,0,0,0,0,1\n",
                             config);
  CHECK(whole.samples[1].time - whole.samples[0].time == Approx(1000001e-9).epsilon(1e-12));
  const Outcome parts = read(kHeader +
                             "1700000000.123456789,0,0,0,0,0,0,1\n"
                             "1700000000.124456790,0,0,0,0,0,0,1\n");
  CHECK(parts.samples[1].time - parts.samples[0].time == Approx(1000001e-9).epsilon(1e-9));
}

TEST_CASE("trajectory file: what was meant otherwise is refused, and says how to write it") {
  // Oracle: the stated rules.
  using Device = scene::TrajectoryDevice;
  CHECK_THAT(
      error_of("t;x;y;z;qx;qy;qz;qw\n0;0,5;0;0;0;0;0;1\n"),
      EndsWith("recording.csv:2: column 2 is '0,5': decimal commas are not read, write points"));
  CHECK_THAT(error_of("t x y z qx qy qz qw\n0 0,5 0 0 0 0 0 1\n"),
             Contains("decimal commas are not read"));
  CHECK_THAT(error_of(kHeader + "0,0,0,5,0,0,0,0,0,0,0,0,1\n0,1,0,0,5,0,0,0,0,0,0,0,0,1\n"),
             Contains("decimal commas are not read"));
  CHECK_THAT(error_of(std::string("\xFF\xFEt\0,\0x\0", 9)),
             Contains(":1: is UTF-16; save it as UTF-8"));
  CHECK_THAT(error_of(std::string("t,x\0,y,z\n", 9)),
             EndsWith(":1: holds a zero byte: it is no text"));
  CHECK_THAT(error_of(kHeader + std::string("0,1\0,0,0,0,0,0,1\n", 17)),
             Contains("column 2 is '1?', not a finite number"));
  Device named;
  named.columns = {"t", "x", "y", "up"};
  CHECK_THAT(error_of("t,x,y,z\n0,0,0,0\n", named),
             EndsWith("recording.csv:1: no column is named 'up'; there are: t,x,y,z"));
  named.columns = {"t", "x", "y", "9"};
  CHECK_THAT(error_of("t,x,y,z\n0,0,0,0\n", named), EndsWith(":1: there is no column 9, only 4"));
  named.columns = {"t", "x", "x", "x"};
  CHECK_THAT(error_of("t,x,x,x\n0,0,0,0\n", named), EndsWith(":1: 3 columns are named 'x'"));
  Device scalar_first;
  scalar_first.quaternion = Device::QuaternionOrder::kWxyz;
  CHECK_THAT(error_of(kHeader, scalar_first), Contains("names decide"));
  // Two recordings in one file; more rows bad than good.
  CHECK_THAT(error_of(kHeader + "5,0,0,0,0,0,0,1\n6,0,0,0,0,0,0,1\n0,0,0,0,0,0,0,1\n"),
             Contains("recording.csv:4: time goes back by 6 s; at most 1 s is taken for disorder"));
  CHECK_THAT(error_of(kHeader + "0,0,0,0,0,0,0,1\n0.1,0,0,0,0,0,0,1\na\nb\nc\n"),
             Contains("recording.csv:6: 3 poses cannot be used, only 2 can"));
}

TEST_CASE("trajectory file: repeated times are left out and may be many, jumps are reported") {
  // Oracle: counting; a step of 50 mm in 10 ms is 5 m/s, faster than any hand.
  std::string repeated = kHeader, jumping = kHeader, turning = kHeader;
  for (int i = 0; i < 100; ++i) {
    const std::string time = std::to_string(0.01 * i);
    repeated += time + ",0,0,0,0,0,0,1\n" + time + ",1,0,0,0,0,0,1\n" + time + ",2,0,0,0,0,0,1\n";
    jumping += time + (i < 50 ? ",0" : ",0.05") + ",0,0,0,0,0,1\n";
    turning += time + ",0,0,0," + (i < 50 ? "0,0,0,1" : "1,0,0,0") + "\n";
  }
  const Outcome first_of_each = read(repeated);
  CHECK(first_of_each.samples.size() == 100);
  CHECK(first_of_each.samples[50].pose.position.x() == 0);
  CHECK_THAT(first_of_each.warnings.back(),
             EndsWith("in all 200 left out, of these 200 with a repeated time"));
  const Outcome jumped = read(jumping);
  REQUIRE(jumped.warnings.size() == 1);
  CHECK_THAT(jumped.warnings[0], EndsWith("recording.csv:52: jump of 50 mm and 0 rad in 0.01 s "
                                          "before t = 0.5 s, played as it is"));
  CHECK(read(turning).warnings.size() == 1);
  // In millimetres: one line that says what to write, not hundreds.
  std::string millimetres = kHeader;
  for (int i = 0; i < 100; ++i) {
    millimetres += std::to_string(0.01 * i) + "," + std::to_string(0.5 * i) + ",0,0,0,0,0,1\n";
  }
  const Outcome fast = read(millimetres);
  REQUIRE(fast.warnings.size() == 1);
  CHECK_THAT(fast.warnings[0],
             Contains("99 of 99 steps are faster than 3 m/s") && Contains("length_unit"));
}

TEST_CASE("trajectory file: reading tells how far it is, and keeps the bound on memory") {
  // Oracle: counting; 80 bytes a pose, stated in table.h. 200,000 lines are three progress calls.
  const ScratchFolder folder;
  std::string text = kHeader;
  for (int i = 0; i < 200'000; ++i) text += std::to_string(0.001 * i) + ",0,0,0,0,0,0,1\n";
  std::vector<std::string> warnings;
  std::vector<double> parts;
  const auto poses = read_trajectory({.file = folder.write("long.csv", text)}, warnings,
                                     [&](double part, std::size_t) { parts.push_back(part); });
  CHECK(poses.size() == 200'000);
  REQUIRE(parts.size() == 3);
  CHECK(parts[2] == Approx(3 * 65536 / 200'000.0).epsilon(0.02));
  CHECK(sizeof(TimedPose) == 80);
  CHECK(double(poses.capacity()) < 1.1 * 200'000);
}

#ifndef __SANITIZE_ADDRESS__  // which needs more than any limit
TEST_CASE("trajectory file: one that memory does not hold is named") {
  // Oracle: a limit on memory, in a process of its own; the file promises fifty million poses.
  const ScratchFolder folder;
  std::string rows = kHeader;
  for (int i = 0; i < 5000; ++i) rows += std::to_string(i) + ",0,0,0,0,0,0,1\n";
  const auto file = folder.write("huge.csv", rows);
  std::filesystem::resize_file(file, 4'000'000'000);
  const pid_t process = ::fork();
  if (process == 0) {
    const rlimit most{2'000'000'000, 2'000'000'000};
    ::setrlimit(RLIMIT_AS, &most);
    std::string said;
    try {
      std::vector<std::string> warnings;
      read_trajectory({.file = file}, warnings);
    } catch (const std::exception& error) {
      said = error.what();
    }
    ::_exit(said == "not enough memory to read " + file.string() ? 0 : 1);
  }
  int status = 0;
  ::waitpid(process, &status, 0);
  CHECK((WIFEXITED(status) && WEXITSTATUS(status) == 0));
}
#endif
