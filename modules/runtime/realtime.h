// Privileges the system may grant a module: real-time priority, locked memory, niceness.
#pragma once

#include <pthread.h>

#include <cstddef>
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

/// Keeps the machine's idle cores from sleeping: a core that sleeps is woken some tens of
/// microseconds late, in a virtual machine some hundreds. Costs power.
class AwakeCores {
 public:
  /// @param file  where the kernel is asked (Documentation/power/pm_qos_interface of Linux)
  explicit AwakeCores(const char* file = "/dev/cpu_dma_latency");
  ~AwakeCores();
  AwakeCores(const AwakeCores&) = delete;
  AwakeCores& operator=(const AwakeCores&) = delete;

  /// One line: why it cannot, and what grants it. Empty if it can, and where the kernel has no such
  /// thing.
  std::string refused() const;
  /// Keeps them awake from now on, while this lives; without the right to, does nothing.
  void keep() const;

 private:
  const char* file_;
  int descriptor_, failure_;
};

/// Puts the calling thread back to normal scheduling.
void give_up_realtime();
/// What was granted before, for the calling thread.
void resume_realtime(int fifo_priority);

/// When woken, the calling thread, and those it starts from now on, wait until a core is free or
/// whoever works there has had its turn: of processes that take turns each ends what it is at.
/// Does nothing for whoever has real-time priority.
void wait_for_turn();

/// The thread, and those it starts from now on, keep to one core, where there are as many
/// cores for it as processes that compute at the same time: where others still work on the core
/// that it was on, it would wait for them while another core idles. @param place  of `count`, from
/// 0
/// @return whether it does
bool keep_to_own_core(std::size_t place, std::size_t count, pthread_t thread = pthread_self());
/// The same among the cores that another thread may use.
bool keep_to_own_core(std::size_t place, std::size_t count, pthread_t thread, pthread_t another);

/// The calling thread, and those it starts from now on, leave the first core to others, where there
/// are so many cores for it, and more than one: real-time work that comes again and again stays on
/// the core it was on last, however busy that one is. @return whether it does
bool leave_first_core(std::size_t count);

/// Gives way to everybody else. @param steps  of niceness, 0 … 19
void lower_priority(int steps);

}  // namespace palpate::runtime
