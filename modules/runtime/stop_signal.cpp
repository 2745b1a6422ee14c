#include "modules/runtime/stop_signal.h"

namespace palpate::runtime {
namespace {

// A signal handler can reach nothing else.
volatile std::sig_atomic_t stop_flag = 0;
int depth = 0;  // of StopSignals one within another

void set_stop_flag(int) { stop_flag = 1; }

}  // namespace

StopSignal::StopSignal() {
  if (depth++ > 0) return;
  stop_flag = 0;
  struct sigaction action {};
  action.sa_handler = set_stop_flag;  // no SA_RESTART: a sleeping loop wakes up
  sigemptyset(&action.sa_mask);
  for (std::size_t i = 0; i < kSignals.size(); ++i) sigaction(kSignals[i], &action, &earlier_[i]);
}

StopSignal::~StopSignal() {
  if (--depth > 0) return;
  for (std::size_t i = 0; i < kSignals.size(); ++i) sigaction(kSignals[i], &earlier_[i], nullptr);
}

bool StopSignal::requested() const { return stop_flag != 0; }

}  // namespace palpate::runtime
