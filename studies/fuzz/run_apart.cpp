#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <stdexcept>

#include "studies/fuzz/lockstep.h"

namespace palpate::fuzz {
namespace {

constexpr unsigned kHungAfter = 120;  // [s], wall time

/// As it goes through the pipe; `what` follows.
struct Sent {
  Ending ending;
  std::array<std::uint32_t, kGuardCount> guards;
  double time;
};

[[noreturn]] void run_as_child(const RandomScene& scene, const ShapeStore& shapes,
                               deformation::Guarding guarding, int pipe) {
  for (const int signal : {SIGALRM, SIGABRT, SIGSEGV, SIGFPE, SIGILL}) std::signal(signal, SIG_DFL);
  ::alarm(kHungAfter);
  ::dup2(pipe, STDERR_FILENO);  // the last words of a crash
  const Outcome outcome = run_lockstep(scene, shapes, guarding);
  const Sent sent{outcome.ending, outcome.guards, outcome.time};
  std::string bytes(reinterpret_cast<const char*>(&sent), sizeof sent);
  bytes += outcome.what.substr(0, 1000);  // less than a pipe holds: one write
  ::_exit(::write(pipe, bytes.data(), bytes.size()) == ssize_t(bytes.size()) ? 0 : 1);
}

std::string read_all(int pipe) {
  std::string bytes;
  char buffer[2048];
  for (;;) {
    const ssize_t count = ::read(pipe, buffer, sizeof buffer);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return bytes;
    bytes.append(buffer, static_cast<std::size_t>(count));
  }
}

int wait_for(pid_t child) {
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

}  // namespace

Outcome run_apart(const RandomScene& scene, const ShapeStore& shapes,
                  deformation::Guarding guarding) {
  int ends[2];
  if (::pipe(ends) != 0) throw std::runtime_error("no pipe to a child process");
  const pid_t child = ::fork();
  if (child < 0) throw std::runtime_error("no child process can be started");
  if (child == 0) run_as_child(scene, shapes, guarding, ends[1]);
  ::close(ends[1]);
  const std::string bytes = read_all(ends[0]);
  ::close(ends[0]);
  const int status = wait_for(child);
  Outcome outcome;
  if (WIFSIGNALED(status) || bytes.size() < sizeof(Sent)) {
    const int signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
    outcome.ending = Ending::kFailed;
    outcome.what =
        signal == SIGALRM ? "hung" : "crash (" + std::string(strsignal(signal)) + "): " + bytes;
    return outcome;
  }
  Sent sent;
  std::memcpy(&sent, bytes.data(), sizeof sent);
  outcome.ending = sent.ending;
  outcome.guards = sent.guards;
  outcome.time = sent.time;
  outcome.what = bytes.substr(sizeof sent);
  return outcome;
}

Outcome run_and_compare(const RandomScene& scene, const ShapeStore& shapes) {
  Outcome outcome = run_apart(scene, shapes);
  if (outcome.ending != Ending::kRan || !outcome.any_guard_of_state()) return outcome;
  const Outcome bare = run_apart(scene, shapes, deformation::Guarding::kOff);
  outcome.unguarded = bare.ending == Ending::kRan ? Unguarded::kFine : Unguarded::kFailed;
  return outcome;
}

}  // namespace palpate::fuzz
