// Hears a session for its tally.
#pragma once

#include "modules/bus/bus.h"
#include "palpate/session_tally.h"

namespace palpate::launcher {

class SessionMonitor {
 public:
  SessionMonitor(bus::Bus& bus, const scene::Scene& scene);

  /// Takes what has arrived. Called at the rate of the node positions it misses none of them.
  void poll();

  /// Names of modules whose state is not yet kReady or beyond (nothing heard, starting).
  std::vector<std::string> not_ready(const std::vector<std::string>& modules) const;

  SessionTally& tally() { return tally_; }
  const SessionTally& tally() const { return tally_; }

 private:
  bus::Reader<ModuleStatus> statuses_;
  bus::Reader<NodePositions> positions_;
  bus::Reader<HapticForce> forces_;
  bus::Reader<ContactModel> laws_;
  ModuleStatus status_;
  NodePositions node_positions_;
  HapticForce force_;
  ContactModel law_;
  SessionTally tally_;
};

}  // namespace palpate::launcher
