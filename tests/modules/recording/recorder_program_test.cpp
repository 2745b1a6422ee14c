// The program palpate-recorder, as a process of its own.
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <chrono>
#include <fstream>
#include <string>
#include <string_view>

#include "modules/core/error.h"
#include "modules/recording/sample_reader.h"
#include "tests/modules/bus/loopback.h"
#include "tests/modules/recording/payloads.h"
#include "tests/modules/recording/recording_files.h"

namespace palpate::recording {
namespace {

using bus::testing::own_options;
using bus::testing::wait_until;

// A running recorder; killed at the end if still there.
class RecorderProcess {
 public:
  RecorderProcess(const std::filesystem::path& file, const bus::BusOptions& options) {
    const std::string program = PALPATE_BIN_DIR "/palpate-recorder";
    const std::string domain = std::to_string(options.domain);
    id_ = fork();
    if (id_ == 0) {
      execl(program.c_str(), program.c_str(), file.c_str(), "--session", options.session.c_str(),
            "--domain", domain.c_str(), "--topics", "all", nullptr);
      _exit(127);
    }
  }
  ~RecorderProcess() {
    if (!ended_) {
      kill(id_, SIGKILL);
      waitpid(id_, &status_, 0);
    }
  }
  /// How often a thread of it has waited for something, so far.
  long waits() const {
    long sum = 0;
    for (const auto& thread :
         std::filesystem::directory_iterator("/proc/" + std::to_string(id_) + "/task")) {
      std::ifstream status(thread.path() / "status");
      for (std::string line; std::getline(status, line);) {
        constexpr std::string_view kCount = "voluntary_ctxt_switches:";
        if (line.starts_with(kCount)) sum += std::stol(line.substr(kCount.size()));
      }
    }
    return sum;
  }
  void send(int signal) const { kill(id_, signal); }
  bool ended() { return ended_ = ended_ || waitpid(id_, &status_, WNOHANG) == id_; }
  /// Exit code, or −1 if a signal ended it.
  int exit_code() const { return WIFEXITED(status_) ? WEXITSTATUS(status_) : -1; }

 private:
  pid_t id_;
  int status_ = 0;
  bool ended_ = false;
};

// Writes node positions until the file has grown by some of them; gives how many were written.
int write_until_recorded(bus::Writer<NodePositions>& writer, const std::filesystem::path& file) {
  const auto size = [&] {
    std::error_code error;
    const auto bytes = std::filesystem::file_size(file, error);
    return error ? 0 : bytes;
  };
  int written = 0;
  const auto target = size() + 20'000;
  CHECK(wait_until([&] {
    NodePositions nodes = node_positions(1, 1e-3, 5);
    written += writer.write(nodes) ? 1 : 0;
    return size() >= target;
  }));
  return written;
}

struct Reading {
  std::size_t samples = 0;
  bool torn = false;
};

Reading read(const std::filesystem::path& file) {
  SampleReader reader(file);
  Reading reading;
  while (reader.next()) ++reading.samples;
  reading.torn = reader.torn();
  return reading;
}

}  // namespace

TEST_CASE("recorder program: on SIGTERM, Ctrl-C and SIGHUP it ends the file and says done") {
  // Oracle: the reader's verdict on the file; the number of samples written by the test.
  const int signal = GENERATE(SIGTERM, SIGINT, SIGHUP);
  const ScratchFolder folder;
  const auto options = own_options();
  bus::DdsBus bus(options);
  auto writer = bus.writer(bus::kNodePositions);
  RecorderProcess recorder(folder / "a.mcap", options);
  REQUIRE(wait_until([&] { return writer.matched_readers() == 1; }));
  const int written = write_until_recorded(writer, folder / "a.mcap");
  recorder.send(signal);
  REQUIRE(wait_until([&] { return recorder.ended(); }));
  CHECK(recorder.exit_code() == kExitDone);
  const Reading reading = read(folder / "a.mcap");
  CHECK_FALSE(reading.torn);
  CHECK(reading.samples > 0);
  CHECK(reading.samples <= static_cast<std::size_t>(written));
}

TEST_CASE("recorder program: samples do not wake it one by one") {
  // Oracle: the kernel's count. At most so many rounds a second, by their periods: 50 of gathering,
  // 25 of taking, 20 of writing, and discovery's; with a thread woken by each sample there were
  // 1200 here.
  constexpr double kMostRounds = 50 + 25 + 20 + 105;  // [1/s]
  constexpr int kCount = 3000;
  const ScratchFolder folder;
  const auto options = own_options();
  bus::DdsBus bus(options);
  auto writer = bus.writer(bus::kHapticForce);
  RecorderProcess recorder(folder / "a.mcap", options);
  REQUIRE(wait_until([&] { return writer.matched_readers() == 1; }));
  const auto began = std::chrono::steady_clock::now();
  const long before = recorder.waits();
  for (int k = 0; k < kCount; ++k) {
    HapticForce force;
    REQUIRE(writer.write(force));
    usleep(900);
  }
  const std::chrono::duration<double> lasted = std::chrono::steady_clock::now() - began;
  CHECK(double(recorder.waits() - before) / lasted.count() < kMostRounds);
  recorder.send(SIGTERM);
  REQUIRE(wait_until([&] { return recorder.ended(); }));
  CHECK(read(folder / "a.mcap").samples > kCount * 9 / 10);
}

TEST_CASE("recorder program: killed hard, what it had written can be read") {
  // Oracle: the reader; the file had grown by 20 KB of 92-byte payloads before the kill.
  const ScratchFolder folder;
  const auto options = own_options();
  bus::DdsBus bus(options);
  auto writer = bus.writer(bus::kNodePositions);
  RecorderProcess recorder(folder / "a.mcap", options);
  REQUIRE(wait_until([&] { return writer.matched_readers() == 1; }));
  write_until_recorded(writer, folder / "a.mcap");
  recorder.send(SIGKILL);
  REQUIRE(wait_until([&] { return recorder.ended(); }));
  CHECK(recorder.exit_code() == -1);
  const Reading reading = read(folder / "a.mcap");
  CHECK(reading.torn);
  CHECK(reading.samples > 100);
}

TEST_CASE("recorder program: a full disk is a failure, a bad domain bad input") {
  // Oracle: exit codes of core/error.h; the kernel's device that is always full.
  RecorderProcess full("/dev/full", own_options());
  REQUIRE(wait_until([&] { return full.ended(); }));
  CHECK(full.exit_code() == kExitFailed);

  const ScratchFolder folder;
  bus::BusOptions bad;
  bad.domain = 999;
  RecorderProcess refused(folder / "a.mcap", bad);
  REQUIRE(wait_until([&] { return refused.ended(); }));
  CHECK(refused.exit_code() == kExitBadInput);
}

}  // namespace palpate::recording
