#include "modules/core/stop_signal.h"

#include <array>
#include <atomic>
#include <csignal>

namespace palpate {
namespace {

constexpr std::array kSignals{SIGINT, SIGTERM, SIGHUP};
/// Of what follows; the handler takes none.
class Alone {
 public:
  Alone() {
    while (busy.test_and_set()) {
    }
  }
  ~Alone() { busy.clear(); }

 private:
  static inline std::atomic_flag busy;
};
std::array<struct sigaction, kSignals.size()> earlier{};

// A signal handler can reach nothing else.
volatile std::sig_atomic_t stop_flag = 0;
int depth = 0;  // of StopSignals one within another

void set_stop_flag(int) { stop_flag = 1; }

volatile std::sig_atomic_t suspend_flag = 0;
struct sigaction earlier_suspension {};

void set_suspend_flag(int) { suspend_flag = 1; }

}  // namespace

StopSignal::StopSignal() {
  const Alone alone;
  if (depth++ > 0) return;
  stop_flag = 0;
  struct sigaction action {};
  action.sa_handler = set_stop_flag;  // no SA_RESTART: a sleeping loop wakes up
  sigemptyset(&action.sa_mask);
  for (std::size_t i = 0; i < kSignals.size(); ++i) {
    sigaction(kSignals[i], nullptr, &earlier[i]);
    if (kSignals[i] == SIGHUP && earlier[i].sa_handler == SIG_IGN) continue;
    sigaction(kSignals[i], &action, nullptr);
  }
}

StopSignal::~StopSignal() {
  const Alone alone;
  if (--depth > 0) return;
  for (std::size_t i = 0; i < kSignals.size(); ++i) sigaction(kSignals[i], &earlier[i], nullptr);
}

bool StopSignal::requested() const { return stop_flag != 0; }

bool stop_requested() {
  const Alone alone;
  return depth > 0 && stop_flag != 0;
}

NoSuspension::NoSuspension() {
  suspend_flag = 0;
  struct sigaction action {};
  action.sa_handler = set_suspend_flag;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  sigaction(SIGTSTP, &action, &earlier_suspension);
}

NoSuspension::~NoSuspension() { sigaction(SIGTSTP, &earlier_suspension, nullptr); }

bool NoSuspension::take() {
  const bool asked = suspend_flag != 0;
  suspend_flag = 0;
  return asked;
}

}  // namespace palpate
