// Privileges the system may grant a module: real-time priority, locked memory, niceness.
#pragma once

#include <string>

namespace palpate::runtime {

struct Realtime {
  bool priority = false;       ///< SCHED_FIFO
  bool memory_locked = false;  ///< no page of the process is ever swapped out
  std::string refused;         ///< one line: what was not granted, why, and what grants it
};

/// Asks for SCHED_FIFO for the calling thread and those it starts from now on: call it before the
/// Bus is made, whose threads inherit. @param fifo_priority  1 … 99
/// @param lock_memory  ask for locked memory, too
Realtime request_realtime(int fifo_priority, bool lock_memory);

/// Puts the calling thread back to normal scheduling.
void give_up_realtime();
/// What was granted before, for the calling thread.
void resume_realtime(int fifo_priority);

/// Gives way to everybody else. @param steps  of niceness, 0 … 19
void lower_priority(int steps);

}  // namespace palpate::runtime
