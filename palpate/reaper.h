// Ends what a launcher leaves behind that was killed and could not end it itself.
#pragma once

#include <sys/types.h>

namespace palpate::launcher {

/// A process of its own that waits for this one to die. Processes told of get SIGTERM then, and
/// SIGKILL if they are still there after kPatience: a stopped or hanging one hears no SIGTERM.
/// Where they end before, it has nothing to do. To be made while the program has one thread.
class Reaper {
 public:
  static constexpr double kPatience = 1.0;  ///< [s]

  Reaper();   ///< @throws std::runtime_error if there can be no process
  ~Reaper();  ///< lets it go; one that hangs or is stopped is killed after twice kPatience
  Reaper(const Reaper&) = delete;
  Reaper& operator=(const Reaper&) = delete;

  /// A child just started, not yet waited for.
  void watch(pid_t child);

 private:
  pid_t process_id_ = -1;
  int children_ = -1;  ///< our end of a pipe
};

}  // namespace palpate::launcher
