// Two error families. Bad input from a person or a file: InputError, reported in one line, exit
// code 2. A broken assumption of ours: PALPATE_DEMAND stops the process with the place.
#pragma once

#include <stdexcept>
#include <string>

namespace palpate {

/// Exit codes of every program.
inline constexpr int kExitDone = 0;
inline constexpr int kExitFailed = 1;     ///< something failed while running
inline constexpr int kExitBadInput = 2;   ///< scene, mesh, recording or option is not acceptable
inline constexpr int kExitStopped = 130;  ///< stopped on request: as shells count Ctrl-C

/// Input that cannot be accepted. The message names the place ("scene.yaml:12"), the key, the
/// value and what is allowed.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Work that ends early because a signal asks for it (StopSignal): exit code kExitStopped.
class Interrupted : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Prints the failed condition with its place and aborts.
[[noreturn]] void demand_failed(const char* condition, const char* file, int line);

}  // namespace palpate

/// Always-on check of an assumption of the code itself (never of user input).
#define PALPATE_DEMAND(condition) \
  ((condition) ? void(0) : ::palpate::demand_failed(#condition, __FILE__, __LINE__))
