// Whether and when a process that ended is started again. Pure: time is an argument.
#pragma once

#include <optional>

namespace palpate::launcher {

/// At once, then after pauses that double; not for ever. One that lasted long enough is forgiven
/// what was before.
class RestartPolicy {
 public:
  static constexpr int kMost = 5;               ///< in a row
  static constexpr double kFirstPause = 0.1;    ///< before the second [s]
  static constexpr double kForgivenAfter = 60;  ///< of going on well [s]

  /// It began to run at `began` and failed at `ended` [s]. @returns the pause before it is started
  /// again [s]; none: never any more
  std::optional<double> pause_after(double began, double ended) {
    if (ended - began >= kForgivenAfter) in_a_row_ = 0;
    if (in_a_row_ == kMost) return std::nullopt;
    const double pause = in_a_row_ == 0 ? 0 : kFirstPause * (1 << (in_a_row_ - 1));
    ++in_a_row_;
    return pause;
  }

 private:
  int in_a_row_ = 0;
};

}  // namespace palpate::launcher
