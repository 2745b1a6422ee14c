// Hears a session for its tally.
#pragma once

#include <set>

#include "haptics/devices/driver_watch.h"
#include "modules/bus/bus.h"
#include "palpate/session_tally.h"

namespace palpate::launcher {

class SessionMonitor {
 public:
  SessionMonitor(bus::Bus& bus, const scene::Scene& scene);

  void poll();  ///< takes what has arrived
  /// Until a status arrives, at most `longest` [s].
  void wait(double longest) { statuses_.wait(longest); }

  /// Names of modules that could not take part now: not heard of, starting, at fault, ended.
  std::vector<std::string> not_ready(const std::vector<std::string>& modules) const;
  /// Those that were heard of, but not for two seconds.
  std::vector<std::string> silent() const;
  /// Those that several processes say they are: what they publish jumps between these. Known of
  /// each for a second.
  std::vector<std::string> several() const;
  /// What is to be said of these, once of each; the tally has it, too.
  std::vector<std::string> take_warnings();
  /// Whom these wait for, for a person: who has not been heard, or said why it takes no part; the
  /// others may wait for them. If there are none, those that are not ready.
  std::vector<std::string> waited_for(const std::vector<std::string>& modules) const;

  SessionTally& tally() { return tally_; }
  const SessionTally& tally() const { return tally_; }

 private:
  bus::Reader<ModuleStatus> statuses_;
  ModuleStatus status_;
  SessionTally tally_;
  std::map<std::string, std::int64_t> heard_ns_;         ///< of each module, by the monotonic clock
  std::map<std::string, haptics::DriverWatch> writers_;  ///< of each module
  std::set<std::string> warned_;                         ///< of which that was said
};

}  // namespace palpate::launcher
