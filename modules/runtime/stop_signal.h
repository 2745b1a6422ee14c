// Ctrl-C, SIGTERM and SIGHUP (the terminal is gone) as a flag that loops look at.
#pragma once

#include <array>
#include <csignal>

namespace palpate::runtime {

/// While one exists, these signals set the flag instead of ending the process. One at a time.
class StopSignal {
 public:
  StopSignal();   ///< clears the flag
  ~StopSignal();  ///< gives the signals back
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  bool requested() const;

 private:
  static constexpr std::array kSignals{SIGINT, SIGTERM, SIGHUP};
  std::array<struct sigaction, kSignals.size()> earlier_{};
};

}  // namespace palpate::runtime
