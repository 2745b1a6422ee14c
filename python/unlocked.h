// Work without the GIL, which the interpreter's end waits for: a thread that wants the GIL back
// after that is ended by Python in the middle of C++, and with it the process.
#pragma once

#include <pybind11/pybind11.h>

#include <chrono>

namespace palpate::python {

/// How often a long call looks for signals.
inline constexpr std::chrono::milliseconds kLookForSignals{50};

/// Gives the GIL to others while it lives.
class Unlocked {
 public:
  enum class AtEnd { kRefused, kAllowed };
  /// @throws ClosedError once the interpreter ends, unless what is done then is allowed
  explicit Unlocked(AtEnd at_end = AtEnd::kRefused) : counted_(at_end) {}
  Unlocked(const Unlocked&) = delete;
  Unlocked& operator=(const Unlocked&) = delete;

  /// To be asked by whatever may last: lets Ctrl-C through, in the main thread.
  /// @throws error_already_set; ClosedError once the interpreter ends
  static void look_for_signals();

 private:
  struct Counted {
    explicit Counted(AtEnd at_end);
    ~Counted();
  };
  Counted counted_;  // gone after the GIL is back
  pybind11::gil_scoped_release release_;
};

/// Refuses further work and waits for what there is. Called with the GIL, at the interpreter's end.
void end_unlocked_work();

}  // namespace palpate::python
