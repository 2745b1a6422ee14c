#include "visualizer/recorder_child.h"

#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>

namespace palpate::visualizer {
namespace {

constexpr std::chrono::seconds kPatience{10};  // the window stands meanwhile
constexpr std::chrono::milliseconds kAskEvery{5};

}  // namespace

RecorderChild::RecorderChild(const std::filesystem::path& program,
                             const std::filesystem::path& file, const bus::BusOptions& session)
    : file_(file) {
  const std::string domain = std::to_string(session.domain);
  const std::array<const char*, 7> words{
      program.c_str(), file_.c_str(),  "--session", session.session.c_str(),
      "--domain",      domain.c_str(), nullptr};
  const pid_t parent = getpid();
  process_id_ = fork();
  if (process_id_ < 0) throw std::runtime_error("cannot start " + program.string());
  if (process_id_ > 0) return;
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != parent) _exit(127);
  setpgid(0, 0);  // Ctrl-C in the terminal is for the launcher
  execv(program.c_str(), const_cast<char* const*>(words.data()));
  _exit(127);
}

RecorderChild::~RecorderChild() { end(); }

bool RecorderChild::running() {
  int status = 0;
  const pid_t waited = process_id_ > 0 ? waitpid(process_id_, &status, WNOHANG) : 0;
  if (waited == 0) return process_id_ > 0;
  whole_ = waited == process_id_ && WIFEXITED(status) && WEXITSTATUS(status) == 0;
  process_id_ = -1;
  return false;
}

bool RecorderChild::end() {
  if (running()) kill(process_id_, SIGTERM);
  const auto give_up = std::chrono::steady_clock::now() + kPatience;
  while (running() && std::chrono::steady_clock::now() < give_up) {
    std::this_thread::sleep_for(kAskEvery);
  }
  if (!running()) return whole_;
  kill(process_id_, SIGKILL);
  waitpid(std::exchange(process_id_, -1), nullptr, 0);
  return false;
}

}  // namespace palpate::visualizer
