// The processes of a run: started, listened to, and ended together.
#pragma once

#include <iosfwd>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "palpate/child_process.h"
#include "palpate/run_options.h"

namespace palpate::launcher {

/// A process that ended before it was told to.
struct ModuleEnd {
  std::string module;
  bool failed = false;      ///< other than by exit code 0
  bool bad_input = false;   ///< by exit code 2
  std::string how;          ///< "killed by signal 9 (Killed)"
  std::string last_error;   ///< its last line that is not information; empty if none
  std::string start_again;  ///< the command that starts it again
};

class ModuleGroup {
 public:
  /// Starts all in order. What they say goes to `log`, line by line.
  /// @throws std::runtime_error naming the program that cannot be started
  ModuleGroup(std::vector<ModuleCommand> commands, std::ostream& log);

  /// Passes on what was said; returns those that ended since the last call.
  std::vector<ModuleEnd> poll();

  /// SIGTERM to all, SIGKILL to whoever is still there after kPatience. The recorder ends last, so
  /// that it hears the others' goodbyes.
  void stop();
  /// The same, but for one module.
  void stop_all_but(const std::string& module);

  bool any_running();
  bool running(const std::string& module);
  /// Those that publish a module_status.
  std::vector<std::string> reporting_modules() const;
  std::map<std::string, std::string> last_words() const;  ///< last line of each

  static constexpr double kPatience = 2.0;  ///< [s]

 private:
  struct Member {
    ModuleCommand command;
    std::unique_ptr<ChildProcess> process;
    bool end_reported = false;
    std::string last_line, last_error;
  };
  void listen(Member& member);
  void stop(bool reporting, const std::string& but);

  std::vector<Member> members_;
  std::ostream& log_;
};

}  // namespace palpate::launcher
