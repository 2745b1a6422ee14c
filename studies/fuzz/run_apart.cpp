#include <poll.h>
#include <sys/prctl.h>
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
constexpr int kAskEvery = 100;        // [ms]

/// As it goes through the pipe; `what` follows.
struct Sent {
  Ending ending;
  std::array<std::uint32_t, kGuardCount> guards;
  double time;
};

[[noreturn]] void run_as_child(const RandomScene& scene, const ShapeStore& shapes,
                               deformation::Guarding guarding, int pipe, pid_t parent) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(1);
  for (const int signal : {SIGALRM, SIGABRT, SIGSEGV, SIGFPE, SIGILL}) std::signal(signal, SIG_DFL);
  ::alarm(kHungAfter);
  ::dup2(pipe, STDERR_FILENO);  // the last words of a crash
  const Outcome outcome = run_lockstep(scene, shapes, guarding);
  const Sent sent{outcome.ending, outcome.guards, outcome.time};
  std::string bytes(reinterpret_cast<const char*>(&sent), sizeof sent);
  bytes += outcome.what.substr(0, 1000);  // less than a pipe holds: one write
  ::_exit(::write(pipe, bytes.data(), bytes.size()) == ssize_t(bytes.size()) ? 0 : 1);
}

/// Ended with this, if it has not been waited for.
class Child {
 public:
  Child(pid_t process, int pipe) : process_(process), pipe_(pipe) {}
  ~Child() {
    ::close(pipe_);
    if (process_ < 0) return;
    ::kill(process_, SIGKILL);
    wait();
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  std::string read_all(const report::KeepGoing& keep_going) const {
    std::string bytes;
    char buffer[2048];
    for (;;) {
      if (keep_going) keep_going();
      pollfd waiting{pipe_, POLLIN, 0};
      if (::poll(&waiting, 1, kAskEvery) <= 0) continue;  // time is up, or a signal came
      const ssize_t count = ::read(pipe_, buffer, sizeof buffer);
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) return bytes;
      bytes.append(buffer, static_cast<std::size_t>(count));
    }
  }

  int wait() {
    int status = 0;
    while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) {
    }
    process_ = -1;
    return status;
  }

 private:
  pid_t process_;
  int pipe_;
};

}  // namespace

Outcome run_apart(const RandomScene& scene, const ShapeStore& shapes,
                  const report::KeepGoing& keep_going, deformation::Guarding guarding) {
  int ends[2];
  if (::pipe(ends) != 0) throw std::runtime_error("no pipe to a child process");
  const pid_t parent = ::getpid(), process = ::fork();
  if (process < 0) throw std::runtime_error("no child process can be started");
  if (process == 0) run_as_child(scene, shapes, guarding, ends[1], parent);
  ::close(ends[1]);
  Child child(process, ends[0]);
  const std::string bytes = child.read_all(keep_going);
  const int status = child.wait();
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

Outcome run_and_compare(const RandomScene& scene, const ShapeStore& shapes,
                        const report::KeepGoing& keep_going) {
  Outcome outcome = run_apart(scene, shapes, keep_going);
  if (outcome.ending != Ending::kRan || !outcome.any_guard_of_state()) return outcome;
  const Outcome bare = run_apart(scene, shapes, keep_going, deformation::Guarding::kOff);
  outcome.unguarded = bare.ending == Ending::kRan ? Unguarded::kFine : Unguarded::kFailed;
  return outcome;
}

}  // namespace palpate::fuzz
