// What a world's simulated time is on its session's clock.
#pragma once

#include <optional>

#include "modules/core/state_archive.h"

namespace palpate::deformation {

/// A world that joins late begins at the time it joins, and one whose session is begun anew, by a
/// launcher that has come back, with that.
class SimulatedTime {
 public:
  /// Before each advance. @param session_time, world_time  [s]
  void pass(double session_time, double world_time) {
    const bool anew = session_time < latest_ - kAnew;
    latest_ = session_time;
    if (begin_ && !anew) return;
    begin_ = session_time;
    world_begin_ = world_time;
  }
  double on_session_clock(double world_time) const {
    return begin_.value_or(0) + (world_time - world_begin_);
  }
  /// Simulated per wall second, after an advance in the cycle that woke at `session_time`.
  double factor(double session_time, double world_time, double period) const {
    return (world_time - world_begin_) / (session_time - begin_.value_or(0) + period);
  }

  void exchange(StateArchive& archive) { archive(begin_, world_begin_, latest_); }

 private:
  static constexpr double kAnew = 0.5;  ///< [s]: clocks of hosts are known better
  std::optional<double> begin_;
  double world_begin_ = 0, latest_ = 0;
};

}  // namespace palpate::deformation
