// The program palpate-recorder, as a process of its own.
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <chrono>
#include <fstream>
#include <string>
#include <string_view>
#include <thread>

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
  RecorderProcess(const std::filesystem::path& file, const bus::BusOptions& options,
                  const std::vector<std::string>& more = {}, rlim_t memory = RLIM_INFINITY) {
    std::vector<std::string> words{PALPATE_BIN_DIR "/palpate-recorder",
                                   file.string(),
                                   "--session",
                                   options.session,
                                   "--domain",
                                   std::to_string(options.domain),
                                   "--topics",
                                   "all"};
    words.insert(words.end(), more.begin(), more.end());
    std::vector<char*> argv;
    for (auto& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    id_ = fork();
    if (id_ == 0) {
      const rlimit limit{memory, memory}, no_core{0, 0};
      setrlimit(RLIMIT_AS, &limit);
      setrlimit(RLIMIT_CORE, &no_core);
      execv(argv[0], argv.data());
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

TEST_CASE("recorder program: no place for a recording, and a bad domain, are bad input") {
  // Oracle: exit codes of core/error.h. It waited for the FIFO's reader, filled the devices, and
  // called the folders a failure.
  const ScratchFolder folder;
  REQUIRE(::mkfifo((folder / "fifo").c_str(), 0600) == 0);
  std::ofstream(folder / "notes.txt") << "no recording\n";
  for (const std::filesystem::path& place :
       {folder / "fifo", std::filesystem::path("/dev/full"), std::filesystem::path("/dev/null"),
        folder.path(), folder / "no" / "a.mcap", folder / "notes.txt"}) {
    CAPTURE(place);
    RecorderProcess refused(place, own_options());
    REQUIRE(wait_until([&] { return refused.ended(); }));
    CHECK(refused.exit_code() == kExitBadInput);
  }
  bus::BusOptions bad;
  bad.domain = 999;
  RecorderProcess refused(folder / "a.mcap", bad);
  REQUIRE(wait_until([&] { return refused.ended(); }));
  CHECK(refused.exit_code() == kExitBadInput);
}

TEST_CASE("recorder program: options of a lockstep are refused without one, and of the others in") {
  // Oracle: exit codes of core/error.h. They were ignored.
  const ScratchFolder folder;
  for (const std::vector<std::string>& more : std::vector<std::vector<std::string>>{
           {"--scene", "press_me"},
           {"--from-snapshot", "x"},
           {"--snapshot-at", "3", "--snapshot", "x"},
           {"--lockstep", "recorder,haptics", "--hears", "haptics", "--scene", "x"}}) {
    CAPTURE(more[0]);
    RecorderProcess refused(folder / "a.mcap", own_options(), more);
    REQUIRE(wait_until([&] { return refused.ended(); }));
    CHECK(refused.exit_code() == kExitBadInput);
    CHECK_FALSE(std::filesystem::exists(folder / "a.mcap"));
  }
}

#ifndef __SANITIZE_ADDRESS__  // which needs more than any limit
TEST_CASE("recorder program: too little memory, for threads too, is an error and no abort") {
  // Oracle: how it ends: by no signal, whatever the limit, from too little to begin with to enough.
  // Of those between, most ended it by SIGABRT: Fast DDS joins threads that it could not start.
  const ScratchFolder folder;
  for (rlim_t megabytes = 45; megabytes <= 120; megabytes += 5) {
    CAPTURE(megabytes);
    RecorderProcess recorder(folder / "a.mcap", own_options(), {}, megabytes << 20);
    const auto began = std::chrono::steady_clock::now();
    while (!recorder.ended() &&
           std::chrono::steady_clock::now() - began < std::chrono::seconds(1)) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    if (!recorder.ended()) recorder.send(SIGTERM);
    REQUIRE(wait_until([&] { return recorder.ended(); }));
    CHECK(recorder.exit_code() != -1);
  }
}
#endif

}  // namespace palpate::recording
