// The processes of a run: started, listened to, and ended together.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "modules/runtime/kept_state.h"
#include "palpate/child_process.h"
#include "palpate/reaper.h"
#include "palpate/restart_policy.h"
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
  bool returns = false;     ///< it is started again by itself
  bool killed = false;      ///< by a signal
};

/// Whether processes that failed are started again (restart_policy.h). Those that refused their
/// input never are.
enum class Restarting : std::uint8_t { kNever, kWithPauses };

class ModuleGroup {
 public:
  /// Starts all in order. What they say goes to `log`, line by line. To be made while the program
  /// has one thread (reaper.h).
  /// @param folder  of this process, as Reaper's; empty: none
  /// @throws std::runtime_error naming the program that cannot be started
  ModuleGroup(std::vector<ModuleCommand> commands, std::ostream& log,
              Restarting restarting = Restarting::kNever, std::filesystem::path folder = {});

  /// Passes on what was said, starts again what is due; returns those that ended since the last
  /// call.
  std::vector<ModuleEnd> poll();

  /// Ends a module that runs but answers no more; poll() tells of it as of any that failed.
  /// @param why  "said nothing for 3 s"
  void kill_hung(const std::string& module, const std::string& why);

  /// SIGTERM to all, SIGKILL to whoever is still there after kPatience. The recorder ends last, so
  /// that it hears the others' goodbyes.
  void stop();
  /// The same, but for one module.
  void stop_all_but(const std::string& module);

  /// How a module's last process ended, told to or not; none: it runs, or there is none. Of one
  /// that did not fail `last_error` is its last line, if that is no information.
  std::optional<ModuleEnd> last_end(const std::string& module);

  std::vector<std::string> deaf() const;  ///< those that stop() had to kill
  bool any_running();                     ///< or about to run again
  bool running(const std::string& module);
  pid_t process_id(const std::string& module) const;  ///< of its last process; -1: no such module
  double computed(const std::string& module) const;   ///< by that process, in all [s]
  std::vector<std::string> modules() const;           ///< all
  /// Those that publish a module_status.
  std::vector<std::string> reporting_modules() const;
  std::map<std::string, std::string> last_words() const;  ///< last line of each
  std::map<std::string, int> restarts() const;            ///< of those that were started again

  static constexpr double kPatience = 2.0;  ///< [s]

 private:
  struct Member {
    ModuleCommand command;
    std::unique_ptr<ChildProcess> process;
    std::unique_ptr<runtime::KeptMemory> kept = {};  ///< nullptr: it keeps nothing
    bool end_reported = false;
    std::string last_line = {}, last_error = {};
    std::string hung = {};  ///< why it was killed
    std::int64_t began_ns = 0;
    RestartPolicy policy = {};
    std::optional<std::int64_t> due_ns = {};  ///< when it is started again
    int restarts = 0;
    bool deaf = false;  ///< did not end when told to
  };
  void start(Member& member);
  void start_due();
  ModuleEnd end_of(Member& member, int wait_status);
  void listen(Member& member);
  void stop(bool reporting, const std::string& but);
  void look_after_reaper();

  Restarting restarting_;
  Reaper reaper_;  // before the members: it outlives them
  RestartPolicy reaper_policy_ = {};
  std::int64_t reaper_began_ns_;
  std::vector<Member> members_;
  std::ostream& log_;
};

}  // namespace palpate::launcher
