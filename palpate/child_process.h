// One program started by the launcher, with what it says.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace palpate::launcher {

/// "exit code 2", "killed by signal 9 (Killed)". @param wait_status  of waitpid()
std::string describe_exit(int wait_status);

/// Runs in a process group of its own, so that a Ctrl-C reaches only the launcher, and gets SIGTERM
/// from the kernel if the launcher dies, so that nothing is left behind. To be started from the
/// launcher's main thread, whose end would count as its death.
class ChildProcess {
 public:
  /// @throws std::runtime_error naming the program if it cannot be started
  /// @param inherited  a descriptor that it gets, too
  /// @param environment  NAME=value each, which it gets in place of the launcher's of that name
  ChildProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments,
               std::optional<int> inherited = {}, const std::vector<std::string>& environment = {});
  ~ChildProcess();  ///< kills it if it still runs
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// The wait status once it has ended.
  std::optional<int> ended();
  /// Whole lines of its stdout and stderr since the last call; after its end also a line without
  /// end. Does not wait.
  std::vector<std::string> take_lines();
  void signal(int number);
  pid_t process_id() const { return process_id_; }

 private:
  pid_t process_id_ = -1;
  int output_ = -1;  ///< our end of the pipe
  std::string partial_line_;
  std::optional<int> wait_status_;
};

}  // namespace palpate::launcher
