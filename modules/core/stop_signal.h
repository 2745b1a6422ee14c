// Ctrl-C, SIGTERM and SIGHUP (the terminal is gone) as a flag that loops look at.
#pragma once

namespace palpate {

/// While one exists, these signals set the flag instead of ending the process. Within another one
/// it is the same flag, whichever thread has it.
class StopSignal {
 public:
  StopSignal();   ///< the outermost clears the flag
  ~StopSignal();  ///< the last one gives the signals back
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  bool requested() const;
};

}  // namespace palpate
