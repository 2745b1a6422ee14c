// Hears a session for its tally.
#pragma once

#include "modules/bus/bus.h"
#include "palpate/session_tally.h"

namespace palpate::launcher {

class SessionMonitor {
 public:
  SessionMonitor(bus::Bus& bus, const scene::Scene& scene);

  void poll();  ///< takes what has arrived
  /// Until a status arrives, at most `longest` [s].
  void wait(double longest) { statuses_.wait(longest); }

  /// Names of modules whose state is not yet kReady or beyond (nothing heard, starting).
  std::vector<std::string> not_ready(const std::vector<std::string>& modules) const;
  /// Whom these wait for: who has not been heard; the others may wait for them. If all were heard,
  /// those that are not ready.
  std::vector<std::string> waited_for(const std::vector<std::string>& modules) const;

  SessionTally& tally() { return tally_; }
  const SessionTally& tally() const { return tally_; }

 private:
  bus::Reader<ModuleStatus> statuses_;
  ModuleStatus status_;
  SessionTally tally_;
};

}  // namespace palpate::launcher
