#include "palpate/reaper.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <stdexcept>
#include <system_error>
#include <utility>
#include <vector>

namespace palpate::launcher {
namespace {

int open_process(pid_t process) { return static_cast<int>(syscall(SYS_pidfd_open, process, 0)); }
void send_signal(int process, int number) {
  syscall(SYS_pidfd_send_signal, process, number, nullptr, 0);
}

bool has_ended(int process) {
  pollfd end{process, POLLIN, 0};
  return poll(&end, 1, 0) == 1;
}

/// All that have not ended within about `ms`.
std::vector<pollfd> left_after(std::vector<pollfd> processes, int ms) {
  constexpr int kRoundMs = 10;
  for (int waited = 0; waited < ms && !processes.empty(); waited += kRoundMs) {
    poll(processes.data(), processes.size(), kRoundMs);
    std::erase_if(processes, [](const pollfd& process) { return process.revents != 0; });
  }
  return processes;
}

/// The C library lets memory be asked for after the fork, even where the program has threads.
[[noreturn]] void wait_and_reap(int children, const std::filesystem::path& folder) {
  setsid();  // signals of the terminal are for the launcher
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) std::signal(number, SIG_IGN);
  prctl(PR_SET_NAME, "palpate-reaper");
  // What the launcher had open is not ours to hold.
  const int null = open("/dev/null", O_RDWR);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) dup2(null, stream);
  constexpr int kKept = STDERR_FILENO + 1;
  if (children != kKept) dup2(children, kKept);
  close_range(kKept + 1, ~0U, 0);
  std::vector<pollfd> processes;
  pid_t child = -1;
  while (true) {
    const ssize_t got = read(kKept, &child, sizeof child);
    if (got < 0 && errno == EINTR) continue;
    if (got != sizeof child) break;  // nobody is left to write: the launcher is gone
    if (const int process = open_process(child); process >= 0) {
      processes.push_back({process, POLLIN, 0});
    }
  }
  for (const pollfd& process : processes) send_signal(process.fd, SIGTERM);
  for (const pollfd& left : left_after(processes, static_cast<int>(1e3 * Reaper::kPatience))) {
    send_signal(left.fd, SIGKILL);
  }
  std::error_code ignored;
  if (!folder.empty()) std::filesystem::remove_all(folder, ignored);
  _exit(0);
}

}  // namespace

Reaper::Reaper(std::filesystem::path folder) : folder_(std::move(folder)) { start(); }

void Reaper::start() {
  // Sockets, not a pipe: who writes to one that is killed gets an error and no SIGPIPE.
  std::array<int, 2> ends{};
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    throw std::runtime_error("cannot make a pair of sockets");
  }
  process_id_ = fork();
  if (process_id_ < 0) {
    for (const int end : ends) close(end);
    throw std::runtime_error("cannot start a process");
  }
  if (process_id_ == 0) {
    close(ends[1]);
    wait_and_reap(ends[0], folder_);
  }
  close(ends[0]);
  children_ = ends[1];
}

Reaper::~Reaper() {
  if (children_ >= 0) close(children_);
  for (const Child& child : watched_) close(child.descriptor);
  if (process_id_ < 0) return;
  const int process = open_process(process_id_);
  const double most = 2 * kPatience;  // it takes one itself, where a child hangs
  if (process < 0 || !left_after({{process, POLLIN, 0}}, static_cast<int>(1e3 * most)).empty()) {
    kill(process_id_, SIGKILL);
  }
  if (process >= 0) close(process);
  while (waitpid(process_id_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

/// A message is sent whole or not at all. A reaper that is gone cannot be told.
void Reaper::tell(pid_t child) const {
  send(children_, &child, sizeof child, MSG_NOSIGNAL | MSG_DONTWAIT);
}

void Reaper::watch(pid_t child) {
  std::erase_if(watched_, [](const Child& earlier) {
    const bool gone = has_ended(earlier.descriptor);
    if (gone) close(earlier.descriptor);
    return gone;
  });
  if (const int process = open_process(child); process >= 0) watched_.push_back({child, process});
  tell(child);
}

std::optional<int> Reaper::ended() {
  int status = 0;
  if (process_id_ < 0 || waitpid(process_id_, &status, WNOHANG) != process_id_) return std::nullopt;
  process_id_ = -1;
  close(children_);
  children_ = -1;
  return status;
}

void Reaper::start_again() {
  start();
  for (const Child& child : watched_) {
    if (!has_ended(child.descriptor)) tell(child.process);  // its number is nobody else's yet
  }
}

}  // namespace palpate::launcher
