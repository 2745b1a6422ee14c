// Ctrl-C and SIGTERM as a flag that loops look at.
#pragma once

#include <csignal>

namespace palpate::runtime {

/// While one exists, SIGINT and SIGTERM set the flag instead of ending the process. One at a time.
class StopSignal {
 public:
  StopSignal();   ///< clears the flag
  ~StopSignal();  ///< gives the signals back
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  bool requested() const;

 private:
  struct sigaction earlier_interrupt_ {
  }, earlier_terminate_{};
};

}  // namespace palpate::runtime
