#include "visualizer/offscreen_display.h"

#include <X11/Xlib.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <stdexcept>

namespace palpate::visualizer {
namespace {

constexpr int kStartTimeoutMs = 15'000;
constexpr int kNiceness = 10;

[[noreturn]] void become_server(const std::string& program, int display_fd, pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != parent) _exit(127);
  setpgid(0, 0);  // Ctrl-C in the terminal is for us; we end the server
  setpriority(PRIO_PROCESS, 0, kNiceness);
  const int null = open("/dev/null", O_RDWR);
  dup2(null, STDIN_FILENO);
  dup2(null, STDOUT_FILENO);
  dup2(null, STDERR_FILENO);
  const std::string fd = std::to_string(display_fd);
  execlp(program.c_str(), program.c_str(), "-displayfd", fd.c_str(), "-screen", "0", "1920x1200x24",
         "-nolisten", "tcp", "-noreset", nullptr);
  _exit(127);
}

/// The display number the server writes when it is ready; empty if it never does.
std::string read_display_number(int fd) {
  std::string digits;
  pollfd ready{fd, POLLIN, 0};
  while (poll(&ready, 1, kStartTimeoutMs) > 0) {
    std::array<char, 16> buffer{};
    const ssize_t count = read(fd, buffer.data(), buffer.size());
    if (count <= 0) return {};
    digits.append(buffer.data(), static_cast<std::size_t>(count));
    if (digits.back() == '\n') return digits.substr(0, digits.size() - 1);
  }
  return {};
}

void end_process(pid_t process) {
  kill(process, SIGTERM);
  waitpid(process, nullptr, 0);
}

}  // namespace

XConnection connect_to_display() {
  return {XOpenDisplay(nullptr), [](void* display) {
            if (display != nullptr) XCloseDisplay(static_cast<Display*>(display));
          }};
}

void draw_with_one_thread() { setenv("LP_NUM_THREADS", "1", /*overwrite=*/0); }

OffscreenDisplay::OffscreenDisplay(const std::string& program) {
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) throw std::runtime_error("cannot make a pipe for Xvfb");
  fcntl(ends[0], F_SETFD, FD_CLOEXEC);
  const pid_t parent = getpid();
  process_id_ = fork();
  if (process_id_ == 0) become_server(program, ends[1], parent);
  close(ends[1]);
  const std::string number = process_id_ > 0 ? read_display_number(ends[0]) : std::string();
  close(ends[0]);
  if (number.empty()) {
    if (process_id_ > 0) end_process(process_id_);
    throw std::runtime_error("no display, and '" + program +
                             "' could not be started: install it (Debian: apt install xvfb), set "
                             "DISPLAY, or run without the visualizer");
  }
  name_ = ":" + number;
  setenv("DISPLAY", name_.c_str(), 1);
}

OffscreenDisplay::~OffscreenDisplay() {
  end_process(process_id_);
  unsetenv("DISPLAY");
}

}  // namespace palpate::visualizer
