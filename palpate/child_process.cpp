#include "palpate/child_process.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <stdexcept>
#include <string_view>

namespace palpate::launcher {
namespace {

/// In the child, after fork: only what is safe there. Returns only if the program cannot start.
int become(const char* program, char* const* arguments, char* const* environment, int output,
           std::optional<int> inherited, pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != parent) return ESRCH;  // the launcher died before the line above
  setpgid(0, 0);
  std::signal(SIGPIPE, SIG_DFL);  // which the launcher may ignore
  dup2(output, STDOUT_FILENO);
  dup2(output, STDERR_FILENO);
  if (inherited) fcntl(*inherited, F_SETFD, 0);
  execve(program, arguments, environment);
  return errno;
}

/// The launcher's own, with `changed` in place of what has the same name. It refers to both.
std::vector<char*> environment_with(const std::vector<std::string>& changed) {
  std::vector<char*> all;
  for (char** own = environ; *own != nullptr; ++own) {
    const std::string_view entry = *own;
    const std::string_view name = entry.substr(0, entry.find('='));
    if (std::ranges::none_of(changed, [&](const std::string& one) {
          return name == std::string_view(one).substr(0, one.find('='));
        })) {
      all.push_back(*own);
    }
  }
  for (const auto& one : changed) all.push_back(const_cast<char*>(one.c_str()));
  all.push_back(nullptr);
  return all;
}

[[noreturn]] void fail(const std::filesystem::path& program, int system_error) {
  std::string said = "cannot start " + program.string() + ": " + std::strerror(system_error);
  if (system_error == ENOENT) {
    said += "; it may not be built: cmake --build --preset release --target " +
            program.filename().string();
  }
  throw std::runtime_error(said);
}

}  // namespace

std::string describe_exit(int wait_status) {
  if (WIFSIGNALED(wait_status)) {
    const int number = WTERMSIG(wait_status);
    return "killed by signal " + std::to_string(number) + " (" + strsignal(number) + ")";
  }
  return "exit code " + std::to_string(WEXITSTATUS(wait_status));
}

ChildProcess::ChildProcess(const std::filesystem::path& program,
                           const std::vector<std::string>& arguments, std::optional<int> inherited,
                           const std::vector<std::string>& environment) {
  const std::string path = program.string();
  std::vector<char*> argv{const_cast<char*>(path.c_str())};
  for (const auto& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  const std::vector<char*> envp = environment_with(environment);

  int output[2], failure[2];
  if (pipe2(output, O_CLOEXEC) != 0) fail(program, errno);
  if (pipe2(failure, O_CLOEXEC) != 0) {
    close(output[0]);
    close(output[1]);
    fail(program, errno);
  }
  const pid_t launcher = getpid();
  process_id_ = fork();
  if (process_id_ == 0) {
    const int error =
        become(path.c_str(), argv.data(), envp.data(), output[1], inherited, launcher);
    const auto written = write(failure[1], &error, sizeof error);
    _exit(written == sizeof error ? 127 : 126);
  }
  close(output[1]);
  close(failure[1]);
  output_ = output[0];
  // closed by a successful exec: then nothing is read
  int error = process_id_ < 0 ? errno : 0;
  const auto got = process_id_ < 0 ? 0 : read(failure[0], &error, sizeof error);
  close(failure[0]);
  if (process_id_ < 0 || got == sizeof error) {
    if (process_id_ > 0) waitpid(process_id_, nullptr, 0);
    close(output_);
    fail(program, error);
  }
  fcntl(output_, F_SETFL, fcntl(output_, F_GETFL) | O_NONBLOCK);
}

ChildProcess::~ChildProcess() {
  if (!ended()) {
    signal(SIGKILL);
    waitpid(process_id_, nullptr, 0);
  }
  close(output_);
}

std::optional<int> ChildProcess::ended() {
  int status = 0;
  if (!wait_status_ && waitpid(process_id_, &status, WNOHANG) == process_id_) wait_status_ = status;
  return wait_status_;
}

std::vector<std::string> ChildProcess::take_lines() {
  const bool last_words = ended().has_value();
  char block[4096];
  for (ssize_t got = read(output_, block, sizeof block); got > 0;
       got = read(output_, block, sizeof block)) {
    partial_line_.append(block, static_cast<std::size_t>(got));
  }
  std::vector<std::string> lines;
  for (auto end = partial_line_.find('\n'); end != std::string::npos;
       end = partial_line_.find('\n')) {
    lines.push_back(partial_line_.substr(0, end));
    partial_line_.erase(0, end + 1);
  }
  if (last_words && !partial_line_.empty()) {
    lines.push_back(partial_line_);
    partial_line_.clear();
  }
  return lines;
}

void ChildProcess::signal(int number) {
  if (!wait_status_) kill(process_id_, number);
}

}  // namespace palpate::launcher
