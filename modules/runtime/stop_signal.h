// Ctrl-C, SIGTERM and SIGHUP (the terminal is gone) as a flag that loops look at.
#pragma once

#include <array>
#include <csignal>

namespace palpate::runtime {

/// While one exists, these signals set the flag instead of ending the process. Within another one
/// it is the same flag. Of one thread.
class StopSignal {
 public:
  StopSignal();   ///< the outermost clears the flag
  ~StopSignal();  ///< the outermost gives the signals back
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  bool requested() const;

 private:
  static constexpr std::array kSignals{SIGINT, SIGTERM, SIGHUP};
  std::array<struct sigaction, kSignals.size()> earlier_{};
};

}  // namespace palpate::runtime
