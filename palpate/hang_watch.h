// Which modules hang. Pure: times are arguments.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <string>

#include "modules/core/units.h"

namespace palpate::launcher {

/// Modules say how they are four times a second, between two of their cycles. One that has said
/// nothing for a while hangs: soon if it does nothing (stopped, waiting for what never comes), late
/// if it computes, for a step may take long.
class HangWatch {
 public:
  static constexpr double kIdle = 3, kComputing = 60;  ///< [s]
  /// A process that has not said a word loads, and may wait for a program of its own [s].
  static constexpr double kLoading = 60;
  static constexpr double kComputes = 0.05;  ///< of a core, at least
  /// A pause of the listener itself counts for this much only: what came meanwhile it has not read.
  static constexpr std::int64_t kLongestStrideNs = kNanosecondsPerSecond / 10;

  /// @param process   a name for this life of it
  /// @param sequence  of its newest status; 0: none yet
  /// @param cpu       what it has computed in all [s]
  /// @returns for how long it has said nothing, as far as the listener was awake, if it hangs; else
  ///          0 [s]
  double hangs_for(const std::string& process, std::uint64_t sequence, double cpu,
                   std::int64_t now_ns) {
    Silence& silence = silences_[process];
    if (silence.looked_ns == 0 || sequence != silence.sequence)
      silence = {sequence, now_ns, 0, cpu};
    silence.silent_ns += std::min(now_ns - silence.looked_ns, kLongestStrideNs);
    silence.looked_ns = now_ns;
    const double silent = seconds_from_ns(silence.silent_ns);
    const bool computes = cpu - silence.cpu > kComputes * silent;
    const double idle = sequence == 0 ? kLoading : kIdle;
    return silent < (computes ? kComputing : idle) ? 0 : silent;
  }

 private:
  struct Silence {
    std::uint64_t sequence = 0;
    std::int64_t looked_ns = 0, silent_ns = 0;
    double cpu = 0;  ///< at its beginning [s]
  };
  std::map<std::string, Silence> silences_;
};

}  // namespace palpate::launcher
