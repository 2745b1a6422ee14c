// How far a long job is, and whether it is to stop.
#pragma once

#include <chrono>
#include <functional>
#include <iosfwd>
#include <string>

namespace palpate::report {

/// Thrown out of a job that was asked to stop.
struct Stopped {};
/// What --help says last.
inline constexpr const char* kExitCodesHelp =
    "Exit code: 0 if it ran to its end, 1 if something failed, 2 for bad input, 130 if it was "
    "stopped "
    "(Ctrl-C); what was done stays.";

/// Asked now and then by long work; throws to end it.
using KeepGoing = std::function<void()>;

class Progress {
 public:
  /// @param stop  true as soon as somebody wants the job to end
  Progress(std::ostream& log, std::function<bool()> stop);

  void begin(const std::string& job);
  /// Prints "job: done of total unit; about … left", at most every two seconds.
  /// @throws Stopped if the job is to stop
  void at(double done, double total, const char* unit);

 private:
  std::ostream& log_;
  std::function<bool()> stop_;
  std::string job_;
  std::chrono::steady_clock::time_point begin_, next_line_;
};

}  // namespace palpate::report
