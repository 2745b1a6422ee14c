#include "modules/runtime/realtime.h"

#include <fcntl.h>
#include <linux/capability.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace palpate::runtime {
namespace {

bool has_capability(int capability) {
  __user_cap_header_struct header{_LINUX_CAPABILITY_VERSION_3, 0};
  __user_cap_data_struct data[2]{};
  if (syscall(SYS_capget, &header, data) != 0) return false;
  return (data[CAP_TO_INDEX(capability)].effective & CAP_TO_MASK(capability)) != 0;
}

/// Under a finite limit, locking future mappings makes mmap itself fail once the limit is reached.
bool may_lock_everything() {
  rlimit limit{};
  return has_capability(CAP_IPC_LOCK) ||
         (getrlimit(RLIMIT_MEMLOCK, &limit) == 0 && limit.rlim_cur == RLIM_INFINITY);
}

/// Which the thread may run on; none where the system does not say.
std::vector<int> cores_for(pthread_t thread) {
  std::vector<int> cores;
  cpu_set_t allowed;
  if (pthread_getaffinity_np(thread, sizeof allowed, &allowed) != 0) return cores;
  for (int core = 0; core < CPU_SETSIZE; ++core) {
    if (CPU_ISSET(core, &allowed)) cores.push_back(core);
  }
  return cores;
}

}  // namespace

Realtime request_realtime(int fifo_priority, bool lock_memory) {
  Realtime granted;
  sched_param parameters{};
  parameters.sched_priority = fifo_priority;
  granted.priority = sched_setscheduler(0, SCHED_FIFO, &parameters) == 0;
  if (!granted.priority) {
    granted.refused = std::string("no real-time priority (") + std::strerror(errno) +
                      "; allow it with 'ulimit -r 80' or CAP_SYS_NICE)";
  }
  if (!lock_memory) return granted;
  granted.memory_locked = may_lock_everything() && mlockall(MCL_CURRENT | MCL_FUTURE) == 0;
  if (!granted.memory_locked) {
    granted.refused += granted.refused.empty() ? "" : "; ";
    granted.refused += "memory not locked (allow it with 'ulimit -l unlimited' or CAP_IPC_LOCK)";
  }
  return granted;
}

AwakeCores::AwakeCores(const char* file)
    : file_(file), descriptor_(::open(file, O_WRONLY | O_CLOEXEC)), failure_(errno) {}

AwakeCores::~AwakeCores() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

std::string AwakeCores::refused() const {
  if (descriptor_ >= 0 || failure_ == ENOENT) return "";
  return std::string("idle cores may sleep (") + std::strerror(failure_) +
         "; allow it with the right to write to " + file_ + ")";
}

void AwakeCores::keep() const {
  if (descriptor_ < 0) return;
  constexpr std::int32_t kLongestWakingUs = 0;
  [[maybe_unused]] const auto asked = ::write(descriptor_, &kLongestWakingUs, sizeof(std::int32_t));
}

void give_up_realtime() {
  const sched_param none{};
  sched_setscheduler(0, SCHED_OTHER, &none);
}

void resume_realtime(int fifo_priority) {
  sched_param parameters{};
  parameters.sched_priority = fifo_priority;
  sched_setscheduler(0, SCHED_FIFO, &parameters);
}

void wait_for_turn() {
  const sched_param none{};
  if (sched_getscheduler(0) == SCHED_OTHER) sched_setscheduler(0, SCHED_BATCH, &none);
}

bool keep_to_own_core(std::size_t place, std::size_t count, pthread_t thread) {
  return keep_to_own_core(place, count, thread, thread);
}

bool keep_to_own_core(std::size_t place, std::size_t count, pthread_t thread, pthread_t another) {
  const auto cores = cores_for(another);
  if (cores.size() != count || place >= count) return false;
  cpu_set_t own;
  CPU_ZERO(&own);
  CPU_SET(cores[place], &own);
  return pthread_setaffinity_np(thread, sizeof own, &own) == 0;
}

bool leave_first_core(std::size_t count) {
  const auto cores = cores_for(pthread_self());
  if (cores.size() != count || count < 2) return false;
  cpu_set_t others;
  CPU_ZERO(&others);
  for (const int core : std::span(cores).subspan(1)) CPU_SET(core, &others);
  return pthread_setaffinity_np(pthread_self(), sizeof others, &others) == 0;
}

void lower_priority(int steps) {
  errno = 0;
  const int ignored = nice(steps);
  static_cast<void>(ignored);
}

}  // namespace palpate::runtime
