// Signals that would end the program, held back where they would leave a file that nobody knows of.
#pragma once

#include <csignal>

namespace palpate {

/// SIGINT, SIGTERM and SIGHUP come when it ends, not before; of the thread that made it.
class SignalsHeldBack {
 public:
  SignalsHeldBack();
  ~SignalsHeldBack();
  SignalsHeldBack(const SignalsHeldBack&) = delete;
  SignalsHeldBack& operator=(const SignalsHeldBack&) = delete;

 private:
  sigset_t before_{};
};

}  // namespace palpate
