#include "visualizer/shared_picture.h"

#include <sched.h>
#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <iostream>
#include <vector>

#include "tests/visualizer/display_or_skip.h"
#include "visualizer/offscreen_display.h"

// Last: Eigen does not stand their macros (Success).
#include <X11/Xlib.h>
#include <X11/Xutil.h>

using namespace palpate::visualizer;

namespace {

/// A window without a frame, and what is on it.
struct Shown {
  Display* display = XOpenDisplay(nullptr);
  Window window = XCreateSimpleWindow(display, DefaultRootWindow(display), 0, 0, 40, 30, 0, 0, 0);

  Shown() {
    XMapWindow(display, window);
    XSync(display, False);
  }
  ~Shown() { XCloseDisplay(display); }
  /// 0xRRGGBB, y down.
  unsigned long pixel(int x, int y) {
    XImage* image = XGetImage(display, window, 0, 0, 40, 30, AllPlanes, ZPixmap);
    const unsigned long value = XGetPixel(image, x, y) & 0xffffff;
    XDestroyImage(image);
    return value;
  }
};

/// Red grows to the right, green upwards.
std::vector<std::uint8_t> ramp(int width, int height) {
  std::vector<std::uint8_t> rgba;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      rgba.insert(rgba.end(), {std::uint8_t(x), std::uint8_t(y), 200, 255});
    }
  }
  return rgba;
}

}  // namespace

TEST_CASE("shared picture: the window shows every pixel where it belongs, at each size",
          "[visualizer]") {
  // Oracle: the server's own copy of the window.
  if (!palpate::visualizer::testing::xvfb_or_skip()) return;
  const OffscreenDisplay server;
  Shown shown;
  const auto picture = SharedPicture::make(shown.display, shown.window);
  REQUIRE(picture);
  for (const auto& [width, height] : {std::pair{40, 30}, std::pair{23, 17}, std::pair{40, 30}}) {
    REQUIRE(picture->show(ramp(width, height), width, height));
    for (const auto& [x, y] : {std::pair{0, 0}, std::pair{22, 3}, std::pair{7, 16}}) {
      const auto up = static_cast<unsigned long>(height - 1 - y);
      CHECK(shown.pixel(x, y) == ((static_cast<unsigned long>(x) << 16) | (up << 8) | 200));
    }
  }
}

TEST_CASE("shared picture: too few pixels are not shown", "[visualizer][fault]") {
  // Oracle: the stated rule.
  if (!palpate::visualizer::testing::xvfb_or_skip()) return;
  const OffscreenDisplay server;
  Shown shown;
  const auto picture = SharedPicture::make(shown.display, shown.window);
  REQUIRE(picture);
  CHECK_FALSE(picture->show(ramp(10, 10), 40, 30));
  CHECK(shown.pixel(0, 0) == 0);
}

TEST_CASE("shared picture: a server that cannot see our memory is told from one that can, twice",
          "[visualizer][fault]") {
  // Oracle: the exit code of a process in an IPC namespace of its own, as of a container; Xlib's
  // own handler of errors ends it with 1.
  if (!palpate::visualizer::testing::xvfb_or_skip()) return;
  const OffscreenDisplay server;
  constexpr int kNoNamespace = 77;
  const pid_t child = fork();
  if (child == 0) {
    if (unshare(CLONE_NEWIPC) != 0) _exit(kNoNamespace);
    Shown shown;
    const auto picture = SharedPicture::make(shown.display, shown.window);
    if (!picture) _exit(2);
    const bool once = picture->show(ramp(40, 30), 40, 30),
               again = picture->show(ramp(40, 30), 40, 30);
    _exit(once || again ? 3 : 0);
  }
  int status = -1;
  REQUIRE(waitpid(child, &status, 0) == child);
  REQUIRE(WIFEXITED(status));
  if (WEXITSTATUS(status) == kNoNamespace) {
    std::cout << "SKIPPED: the kernel allows no IPC namespace\n";
    return;
  }
  CHECK(WEXITSTATUS(status) == 0);
}
