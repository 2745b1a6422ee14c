// Ctrl-C, SIGTERM and SIGHUP (the terminal is gone) as a flag that loops look at. SIGHUP stays
// ignored where it was when the program began (nohup).
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

/// Whether one exists and a signal came; for long work that is itself no reason to hold signals
/// back.
bool stop_requested();

/// While one exists, Ctrl-Z (SIGTSTP) does not stop the program: for one whose children would go on
/// without it. One at a time.
class NoSuspension {
 public:
  NoSuspension();
  ~NoSuspension();
  NoSuspension(const NoSuspension&) = delete;
  NoSuspension& operator=(const NoSuspension&) = delete;

  bool take();  ///< whether it was asked for since the last call
};

}  // namespace palpate
