// Ends what a launcher leaves behind that was killed and could not end it itself.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <vector>

namespace palpate::launcher {

/// A process of its own that waits for this one to die. Processes told of get SIGTERM then, and
/// SIGKILL if they are still there after kPatience: a stopped or hanging one hears no SIGTERM.
/// A folder of this process is removed when they have ended. Where they end before, it has nothing
/// to do. Nobody is killed by its own end.
class Reaper {
 public:
  static constexpr double kPatience = 1.0;  ///< [s]

  /// @param folder  with what they read; empty: none
  /// @throws std::runtime_error if there can be no process
  explicit Reaper(std::filesystem::path folder = {});
  ~Reaper();  ///< lets it go; one that hangs or is stopped is killed after twice kPatience
  Reaper(const Reaper&) = delete;
  Reaper& operator=(const Reaper&) = delete;

  /// A child just started, not yet waited for.
  void watch(pid_t child);
  /// The wait status, once, of one that somebody has killed.
  std::optional<int> ended();
  /// Another one in its place, which watches whom it watched.
  /// @throws std::runtime_error if there can be no process
  void start_again();

 private:
  struct Child {
    pid_t process;
    int descriptor;  ///< of the process
  };
  void start();
  void tell(pid_t child) const;

  std::filesystem::path folder_;
  pid_t process_id_ = -1;       ///< -1: it has ended
  int children_ = -1;           ///< our end of a pair of sockets
  std::vector<Child> watched_;  ///< not known to have ended
};

}  // namespace palpate::launcher
