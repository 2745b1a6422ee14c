#include "visualizer/recorder_child.h"

#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <stdexcept>
#include <string>

namespace palpate::visualizer {

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

RecorderChild::~RecorderChild() {
  if (!running()) return;
  kill(process_id_, SIGTERM);
  waitpid(process_id_, nullptr, 0);
}

bool RecorderChild::running() {
  if (process_id_ > 0 && waitpid(process_id_, nullptr, WNOHANG) == process_id_) process_id_ = -1;
  return process_id_ > 0;
}

}  // namespace palpate::visualizer
