// How long a list of jobs will still take, by what those that are done took.
#pragma once

#include <chrono>
#include <string>

namespace palpate::report {

/// "; about 3 min left", "; about 40 s left". @param seconds  NaN, not known: nothing
std::string text_of_time_left(double seconds);

class Pace {
 public:
  void begin() { start_ = Clock::now(); }
  /// @param weight  of the job that is done, in any unit
  void finish(double weight);
  /// [s]; NaN before the first
  double seconds_for(double weight) const;

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_;
  double seconds_ = 0, weight_ = 0;
};

}  // namespace palpate::report
