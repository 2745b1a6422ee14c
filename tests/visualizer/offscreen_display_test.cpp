#include "visualizer/offscreen_display.h"

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <cerrno>
#include <cstdlib>

#include "tests/visualizer/display_or_skip.h"

using namespace palpate::visualizer;

TEST_CASE("off-screen display: accepts clients while it lives and leaves no process",
          "[visualizer]") {
  // Oracle: the X library connects, then does not; the kernel knows no such process.
  if (!palpate::visualizer::testing::xvfb_or_skip()) return;
  pid_t server = 0;
  {
    const OffscreenDisplay display;
    server = display.process_id();
    CHECK(std::getenv("DISPLAY") == display.name());
    CHECK(connect_to_display());
  }
  CHECK_FALSE(connect_to_display());
  CHECK(kill(server, 0) == -1);
  CHECK(errno == ESRCH);
}

TEST_CASE("off-screen display: two at once have different numbers", "[visualizer]") {
  // Oracle: inequality.
  if (!palpate::visualizer::testing::xvfb_or_skip()) return;
  const OffscreenDisplay first, second;
  CHECK(first.name() != second.name());
}

TEST_CASE("off-screen display: ends with its parent even if that is killed",
          "[visualizer][fault]") {
  // Oracle: the pipe that the server's parent shares with it is closed only when both are gone.
  if (!palpate::visualizer::testing::xvfb_or_skip()) return;
  int report[2], alive[2];
  REQUIRE(pipe(report) == 0);
  REQUIRE(pipe(alive) == 0);
  const pid_t child = fork();
  if (child == 0) {
    close(alive[0]);
    const OffscreenDisplay display;
    const pid_t server = display.process_id();
    if (write(report[1], &server, sizeof server) != sizeof server) _exit(1);
    pause();
    _exit(0);
  }
  close(alive[1]);
  pid_t server = 0;
  REQUIRE(read(report[0], &server, sizeof server) == sizeof server);
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  char byte = 0;
  CHECK(read(alive[0], &byte, 1) == 0);  // blocks while anyone holds the other end
  for (const int fd : {report[0], report[1], alive[0]}) close(fd);
}

TEST_CASE("off-screen display: a missing Xvfb is named with what to install",
          "[visualizer][fault]") {
  // Oracle: the message.
  CHECK_THROWS_WITH(OffscreenDisplay("no-such-server"),
                    "no display, and 'no-such-server' could not be started: install it (Debian: "
                    "apt install xvfb), set DISPLAY, or run without the visualizer");
}
