// Who uses an object that Python threads can reach at the same time.
#pragma once

#include <atomic>
#include <stdexcept>

namespace palpate::python {

/// Told to Python as palpate.ClosedError.
struct ClosedError : std::runtime_error {
  using std::runtime_error::runtime_error;
};
/// Told to Python as palpate.BusyError.
struct BusyError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Held during a call; a second one at the same time is refused. Waiting instead would let two
/// threads that hold each other's turn stand still for ever.
class InUse {
 public:
  InUse(std::atomic_flag& flag, const char* what) : flag_(flag) {
    if (flag_.test_and_set())
      throw BusyError(std::string(what) + " is in use by another thread: one at a time");
  }
  ~InUse() { flag_.clear(); }
  InUse(const InUse&) = delete;
  InUse& operator=(const InUse&) = delete;

 private:
  std::atomic_flag& flag_;
};

}  // namespace palpate::python
