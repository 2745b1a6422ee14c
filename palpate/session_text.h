// The session in words: the line of every second, and the summary at the end.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "modules/bus/bus.h"
#include "modules/core/units.h"
#include "palpate/session_tally.h"

namespace palpate::launcher {

/// "  12.0 s  real time 1.00  V/V0 stomach 1.000000  force probe 0.53 N  haptics 1000 Hz …"
/// @param time  of the session [s]
/// @param away  modules whose processes do not run, or are not heard: what they said last is no
/// news
std::string status_line(const SessionTally& tally, double time,
                        const std::vector<std::string>& away = {});

/// How often a launcher says whom it waits for [ns].
inline constexpr std::int64_t kWaitingLineEveryNs = 5 * kNanosecondsPerSecond;

/// "waiting for deformation; …": and what may be why.
/// @param secured  only who has keys is heard  @param refused  by the launcher
std::string waiting_line(const std::vector<std::string>& names, bool secured,
                         const bus::Refusals& refused);

struct SessionEnd {
  std::string scene;
  double session_time = 0;                        ///< [s]
  double wall_time = 0;                           ///< from start to stop [s]
  std::map<std::string, std::string> last_words;  ///< of each module: its last line
  std::map<std::string, std::string> failures;    ///< module → how it ended
  bool lockstep = false;                          ///< no cycle was early or late
  std::map<std::string, int> restarts = {};       ///< module → how often it was started again
  std::string recording = {};                     ///< why it ended earlier; empty: it did not
};

/// One screen.
std::string summary(const SessionTally& tally, const SessionEnd& end);

/// "saturated, stale": the names of ForceLimit bits; "none".
std::string limit_names(std::uint32_t limits);

}  // namespace palpate::launcher
