#include "modules/core/standard_streams.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <csignal>
#include <functional>
#include <iostream>

using namespace palpate;

namespace {

/// Exit code of a process of its own that does this; -1: a signal ended it.
int exit_code_after(const std::function<int()>& job) {
  std::cout.flush();
  std::fflush(nullptr);
  const pid_t process = fork();
  if (process == 0) _exit(job());
  int status = 0;
  waitpid(process, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/// Whether words on standard output, put there, count as lost, for this reason.
int output_on(const char* file, const std::string& reason, std::size_t letters) {
  return exit_code_after([&] {
    dup2(open(file, O_WRONLY), STDOUT_FILENO);
    std::cout << std::string(letters, 'x');
    const std::string why = why_output_is_lost();
    if (reason.empty()) return why.empty() ? 0 : 1;
    return why.find(reason) != std::string::npos && why_output_is_lost() == why ? 0 : 1;
  });
}

}  // namespace

TEST_CASE("standard streams: no file that is opened gets the number of one that was closed") {
  // Oracle: POSIX: the lowest number that is free is given.
  for (int closed = 0; closed < 8; ++closed) {
    CAPTURE(closed);
    CHECK(exit_code_after([&] {
            for (int i = 0; i < 3; ++i) {
              if ((closed >> i & 1) != 0) close(i);
            }
            open_standard_descriptors();
            const int next = open("/dev/zero", O_RDONLY);
            if (next <= STDERR_FILENO) return 1;
            for (int i = 0; i < 3; ++i) {
              if ((closed >> i & 1) != 0 && write(i, "x", 1) != 1) return 2;
            }
            return 0;
          }) == 0);
  }
}

TEST_CASE("standard streams: output that a full disk did not take is lost, and the reason known") {
  // Oracle: ENOSPC of /dev/full. More than a buffer fails before the end, and is not forgotten.
  CHECK(output_on("/dev/full", "No space left on device", 10) == 0);
  CHECK(output_on("/dev/full", "No space left on device", 1'000'000) == 0);
  CHECK(output_on("/dev/null", "", 1'000'000) == 0);
}

TEST_CASE("standard streams: who reads no further has lost nothing") {
  // Oracle: definition; SIGPIPE else ends the program.
  CHECK(exit_code_after([] {
          outlive_readers();
          int ends[2];
          if (pipe(ends) != 0) return 2;
          dup2(ends[1], STDOUT_FILENO);
          close(ends[0]);
          std::cout << "x\n";
          return why_output_is_lost().empty() ? 0 : 1;
        }) == 0);
}
