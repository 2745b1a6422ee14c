#include "modules/runtime/stop_signal.h"

namespace palpate::runtime {
namespace {

// A signal handler can reach nothing else.
volatile std::sig_atomic_t stop_flag = 0;

void set_stop_flag(int) { stop_flag = 1; }

}  // namespace

StopSignal::StopSignal() {
  stop_flag = 0;
  struct sigaction action {};
  action.sa_handler = set_stop_flag;  // no SA_RESTART: a sleeping loop wakes up
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, &earlier_interrupt_);
  sigaction(SIGTERM, &action, &earlier_terminate_);
}

StopSignal::~StopSignal() {
  sigaction(SIGINT, &earlier_interrupt_, nullptr);
  sigaction(SIGTERM, &earlier_terminate_, nullptr);
}

bool StopSignal::requested() const { return stop_flag != 0; }

}  // namespace palpate::runtime
